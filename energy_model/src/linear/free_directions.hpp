#pragma once

#include <Eigen/Core>
#include <Eigen/QR>
#include <optional>

#include "linear/reduced_hessian.hpp"

namespace dlo::energy_model {

/// Eigenvalues closer to zero than this are those of zero modes.
inline constexpr double neutral = 1e-7;

/// Solutions of a singular system of Newton's method by least squares: they stand still in neutral
/// directions, in which a gradient of rounding would move anywhere.
class AcrossNeutral {
 public:
  explicit AcrossNeutral(const Eigen::MatrixXd& system);

  [[nodiscard]] Eigen::VectorXd step(const Eigen::VectorXd& right) const {
    return factor_.solve(right);
  }

 private:
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor_;
};

/// Smallest eigenvalue of the Hessian on these directions, larger by a hundredth at most, if it is
/// positive and above this; else all of them, growing. None if the constraints leave no direction.
[[nodiscard]] Eigen::VectorXd smallest_eigenvalues(ReducedHessian& hessian, double above);

/// Unit direction of one of them, of those that the constraints leave, by growing size from 0.
[[nodiscard]] Eigen::VectorXd direction_by_size(ReducedHessian& hessian, Eigen::Index index);

/// Whether no eigenvalue of a matrix, of which the lower half is read, is negative.
[[nodiscard]] bool is_minimum(const Eigen::MatrixXd& hessian);

/// The direction of the smallest eigenvalue, whatever it is; none if the constraints leave none.
[[nodiscard]] std::optional<Eigen::VectorXd> softest_direction(const Eigen::MatrixXd& hessian,
                                                               const Eigen::MatrixXd& jacobian);

/// The direction in which an unstable equilibrium gives way first; none if it is stable.
[[nodiscard]] std::optional<Eigen::VectorXd> negative_curvature_direction(
    const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian);

}  // namespace dlo::energy_model
