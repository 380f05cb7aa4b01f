#pragma once

#include <Eigen/Core>
#include <optional>

#include "linear/reduced_hessian.hpp"

namespace dlo::energy_model {

/// Eigenvalues closer to zero than this are those of zero modes.
inline constexpr double neutral = 1e-7;

/// Smallest eigenvalue of the Hessian on these directions, larger by a hundredth at most, if it is
/// positive and above this; else all of them, growing. None if the constraints leave no direction.
[[nodiscard]] Eigen::VectorXd smallest_eigenvalues(ReducedHessian& hessian, double above);

/// Unit direction of one of them, of those that the constraints leave, by growing size from 0.
[[nodiscard]] Eigen::VectorXd direction_by_size(ReducedHessian& hessian, Eigen::Index index);

/// Whether no eigenvalue of a matrix, of which the lower half is read, is negative.
[[nodiscard]] bool is_minimum(const Eigen::MatrixXd& hessian);

/// The direction of the smallest eigenvalue, if that is negative by more than `neutral`.
[[nodiscard]] std::optional<Eigen::VectorXd> negative_curvature_direction(
    const ReducedHessian& hessian);

}  // namespace dlo::energy_model
