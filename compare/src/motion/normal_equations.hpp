#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "motion/motion_misfit.hpp"

namespace dlo::compare {

/// Sum of squares and prior about one point, with the derivatives of that point or an earlier one.
/// A step is that of a logarithm, but of a damping its change divided by the damping, because the
/// residuals are nearly linear in a damping and need not determine its logarithm.
class NormalEquations {
 public:
  NormalEquations(const LeastSquares& at, const MotionMisfit& misfit, Eigen::Index free)
      : misfit_(misfit),
        normal_(at.derivatives.transpose() * at.derivatives / at.variance),
        prior_(misfit.prior()),
        variance_(at.variance) {
    gradient_ = at.derivatives.transpose() * at.residuals / at.variance +
                prior_.cwiseProduct(at.parameters);
    gradient_.head(free).setZero();
    normal_.diagonal() += prior_;
    // The prior's second derivative by the damping itself.
    for (Eigen::Index i = 0; i < misfit.physical(); ++i) {
      if (misfit.is_damping(i)) normal_(i, i) += prior_[i] * std::max(0.0, -at.parameters[i]);
    }
  }
  /// Returns the step that lowers the sum most and reduces no damping more than tenfold.
  [[nodiscard]] Eigen::VectorXd step(double marquardt) const {
    constexpr double lowest = -0.9;
    constexpr double rounding = 1e-9;
    Eigen::MatrixXd matrix = normal_;
    matrix.diagonal() *= 1 + marquardt;
    Eigen::VectorXd right = -gradient_;
    for (;;) {
      const Eigen::VectorXd result = matrix.ldlt().solve(right);
      bool within = true;
      for (Eigen::Index i = 0; i < misfit_.physical(); ++i) {
        if (!misfit_.is_damping(i) || !(result[i] < lowest - rounding)) continue;
        within = false;
        right -= lowest * matrix.col(i);
        matrix.row(i).setZero();
        matrix.col(i).setZero();
        matrix(i, i) = 1;
        right[i] = lowest;
      }
      if (within) return result;
    }
  }
  /// Returns parameters after a step, within the bounds.
  [[nodiscard]] Eigen::VectorXd after(const Eigen::VectorXd& step,
                                      Eigen::VectorXd parameters) const {
    for (Eigen::Index i = 0; i < step.size(); ++i) {
      parameters[i] += misfit_.is_damping(i) ? std::log1p(step[i]) : step[i];
      if (i < misfit_.physical()) parameters[i] = MotionMisfit::within_bounds(parameters[i]);
    }
    return parameters;
  }
  /// Twice the decrease of the sum of squares, in variances, that a full step predicts.
  [[nodiscard]] double decrease() const {
    const Eigen::VectorXd full = step(0);
    return -2 * gradient_.dot(full) - full.dot(normal_ * full);
  }
  /// Sum of squares of residuals and parameters, in variances.
  [[nodiscard]] double sum(const Eigen::VectorXd& residuals,
                           const Eigen::VectorXd& parameters) const {
    return residuals.squaredNorm() / variance_ + parameters.dot(prior_.cwiseProduct(parameters));
  }

 private:
  const MotionMisfit& misfit_;
  Eigen::MatrixXd normal_;
  Eigen::VectorXd gradient_, prior_;
  double variance_;
};

}  // namespace dlo::compare
