#pragma once

#include <Eigen/Core>

namespace dlo::energy_model {

/// A collocation Runge-Kutta method.
struct CollocationRule {
  Eigen::VectorXd nodes;    ///< c, in (0, 1]
  Eigen::VectorXd weights;  ///< b
  Eigen::MatrixXd inner;    ///< a_ij: integrals of the stages to c_i
  Eigen::MatrixXd twice;    ///< a a: double integrals of the stages to c_i
  Eigen::MatrixXd through;  ///< stages to coefficients of Legendre's polynomials
  Eigen::RowVectorXd last;  ///< b a: stages to the double integral over the step

  /// Returns the weights of the stages in their interpolating polynomial at a time within the step,
  /// given as a fraction of the step.
  [[nodiscard]] Eigen::RowVectorXd interpolation(double at) const;
  /// Returns the matrix that extrapolates the stages of a step to those of the next one, which is
  /// `ratio` times as long.
  [[nodiscard]] Eigen::MatrixXd extrapolation(double ratio) const;
};

/// Returns Gauss's rule. Its order is twice the number of stages; it is symmetric and does not damp
/// vibrations.
[[nodiscard]] CollocationRule gauss_rule(int stages);

/// Returns the Radau IIA rule. Its order is twice the number of stages minus one; it damps fast
/// decaying components within a step.
[[nodiscard]] CollocationRule radau_rule(int stages);

}  // namespace dlo::energy_model
