#pragma once

#include <Eigen/Core>

#include "dlo/force_model/step_size.hpp"

namespace dlo::force_model {

/// Upper bound of the fastest mode in the present shape, and estimate of the slowest mode that
/// still moves: -dF.dP / dP.dP over blocks of steps, with decreasing weight of older blocks.
///
/// Each step rounds the positions by about eps x, x the largest coordinate. Momentum accumulates
/// the squares of 1 / (1 - c_h) such errors, and a stiff rod responds with the forces of its
/// fastest modes, so that rounding alone makes
///     -dF.dP = k N fastest (eps x)^2 / (1 - c_h),   1 - c_h = 4 sqrt(slowest / fastest),
/// with k measured at rest as 0.005 to 0.035 for rods whose fastest mode bends (N = 16 to 1000) and
/// up to 0.35 for one that stretches (c_c = 1e9 N). A block whose value is at most that of k = 2
/// does not determine the slowest mode and is ignored. When it was used, rounding stopped a rod of
/// 1000 points a thousandth of its length from rest.
///
/// The quotient is far above the slowest mode if faster modes move more, as those that a contact
/// excites. Steps with such an estimate hardly move slow modes: no block is above rounding any
/// more, the estimate does not change, and the rod creeps forever. Only the tangent stiffness
/// distinguishes this from rest, so a caller that has factorised it corrects the estimate.
class ModeEstimate {
 public:
  ModeEstimate(const Rod& rod, const Eigen::Matrix3Xd& points);

  /// Updates the modes after a block of steps.
  /// @param inner_mode    bound of the fastest mode of contraction, bending and twist [N/m]
  /// @param force_change  -dF.dP of the block [N m]
  /// @param point_change  dP.dP of the block [m^2]. The changes of the first call, and of
  /// the first after another function below, are ignored.
  void update(double inner_mode, double force_change, double point_change);

  /// Updates the bounds after a change of the rod's walls. The next update starts a new block, and
  /// its changes are ignored.
  void change_environment(const Rod& rod, const Eigen::Matrix3Xd& points);

  /// Updates the fastest mode alone, during steps without momentum. Their movements consist of fast
  /// modes, which they damp, and of rounding, and do not determine the slowest mode. The next
  /// update starts a new block.
  void update_fastest(double inner_mode);

  /// Restarts the estimate with this stiffness if the estimate is more than twice as large.
  /// @param slowest  slowest mode of the tangent stiffness of the present shape; infinity: unknown
  /// [N/m]
  void correct_slowest(double slowest);

  [[nodiscard]] const ModeBounds& modes() const { return modes_; }

 private:
  ModeBounds modes_;
  double constraints_ = 0;
  double rounding_ = 0;  // 2 N (eps x)^2 [m^2]
  double force_change_ = 0;
  double point_change_ = 0;
  bool has_block_start_ = false;
};

}  // namespace dlo::force_model
