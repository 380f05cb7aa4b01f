#pragma once

#include <Eigen/Core>
#include <optional>

#include "linear/reduced_hessian.hpp"

namespace dlo::energy_model {

/// Magnitude below which an eigenvalue counts as zero.
inline constexpr double neutral = 1e-7;

/// Returns the smallest eigenvalue of the reduced Hessian, overestimated by at most 1 %, as the
/// only element if it is positive and exceeds `above`; otherwise all eigenvalues in ascending
/// order. Returns an empty vector if the constraints leave no direction free.
[[nodiscard]] Eigen::VectorXd smallest_eigenvalues(ReducedHessian& hessian, double above);

/// Returns the eigenvector (in the unknowns, unit length) of the eigenvalue that is number `index`
/// by magnitude, counted from 0 at the smallest.
[[nodiscard]] Eigen::VectorXd direction_by_size(ReducedHessian& hessian, Eigen::Index index);

/// Whether no eigenvalue of a symmetric matrix is below -`neutral`; only the lower half is read.
[[nodiscard]] bool is_minimum(const Eigen::MatrixXd& hessian);

/// Returns the unit eigenvector of the smallest eigenvalue if that is at most -`neutral`.
[[nodiscard]] std::optional<Eigen::VectorXd> negative_curvature_direction(
    const ReducedHessian& hessian);

}  // namespace dlo::energy_model
