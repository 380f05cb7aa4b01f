#pragma once

#include <Eigen/Core>

namespace dlo::energy_model {

/// Steps of Newton's method with the factor of an earlier point, as Broyden's updates of that
/// factor make them: they shrink faster than linearly and cost no more than products of vectors
/// (Deuflhard, Newton Methods for Nonlinear Problems, algorithm QNERR).
class BroydenSteps {
 public:
  /// For another factor.
  void clear() { count_ = 0; }

  /// @param last          the whole step that was just taken
  /// @param[in,out] next  the step that the factor gives after it; the updated one
  void update(const Eigen::VectorXd& last, Eigen::VectorXd& next);

 private:
  Eigen::MatrixXd steps_;  // taken since the factor, one a column
  Eigen::Index count_ = 0;
};

}  // namespace dlo::energy_model
