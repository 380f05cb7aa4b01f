#pragma once

#include <Eigen/Core>

namespace dlo::energy_model {

/// A Runge-Kutta method by collocation.
struct CollocationRule {
  Eigen::VectorXd nodes;    ///< c, in (0, 1]
  Eigen::VectorXd weights;  ///< b
  Eigen::MatrixXd inner;    ///< a_ij: from stages to int_0^c_i
  Eigen::MatrixXd twice;    ///< a a
  Eigen::MatrixXd through;  ///< from stages to coefficients of Legendre's polynomials
  Eigen::RowVectorXd last;  ///< b a: from stages to the double integral over the step

  /// From the stages to a time within the step, as a share of it, by the polynomial through them.
  [[nodiscard]] Eigen::RowVectorXd interpolation(double at) const;
  /// From the stages of a step to those of the next one, `ratio` times as long.
  [[nodiscard]] Eigen::MatrixXd extrapolation(double ratio) const;
};

/// Gauss' with so many stages: order twice as high, symmetric, keeps what vibrates.
[[nodiscard]] CollocationRule gauss_rule(int stages);

/// Radau's IIA with so many stages: order twice as high less one; what decays fast is gone after
/// a step.
[[nodiscard]] CollocationRule radau_rule(int stages);

}  // namespace dlo::energy_model
