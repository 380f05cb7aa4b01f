#pragma once

#include <Eigen/Core>

namespace dlo::energy_model {

/// Broyden's updates of Newton steps that use the factor of an earlier point. The steps converge
/// superlinearly and cost only products of vectors (Deuflhard, Newton Methods for Nonlinear
/// Problems, algorithm QNERR).
class BroydenSteps {
 public:
  /// Discards the updates; call it after a new factorisation.
  void clear() { count_ = 0; }

  /// Updates the step that the factor gives after the whole step `last`.
  /// @param last          the whole step that was just taken
  /// @param[in,out] next  the step from the factor; on return the updated step
  void update(const Eigen::VectorXd& last, Eigen::VectorXd& next);

 private:
  Eigen::MatrixXd steps_;  // taken since the factorisation, one per column
  Eigen::Index count_ = 0;
};

}  // namespace dlo::energy_model
