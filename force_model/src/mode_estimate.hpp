#pragma once

#include <Eigen/Core>

#include "dlo/force_model/step_size.hpp"

namespace dlo::force_model {

/// The fastest mode's bound in the present shape and an estimate of the slowest mode that still
/// moves, -dF.dP / dP.dP over blocks of steps, older blocks fading out.
///
/// Each step rounds the positions, by about eps x, x the largest coordinate. Momentum adds up the
/// squares of 1 / (1 - c_h) such kicks, and a stiff rod answers with the forces of its fastest
/// modes, so that rounding alone makes
///     -dF.dP = k N fastest (eps x)^2 / (1 - c_h),   1 - c_h = 4 sqrt(slowest / fastest),
/// with k measured at rest as 0.005 to 0.035 for rods whose fastest mode bends (N = 16 to 1000)
/// and up to 0.35 for one that stretches (c_c = 1e9 N). A block with no more than k = 2 of it says
/// too little about the slowest mode and is left out: taken for it, rounding stopped a rod of 1000
/// points a thousandth of its length from rest.
///
/// The quotient is far above the slowest mode where faster ones move more, as those that a contact
/// kicks do. Steps made for such an estimate hardly move what is slow: no block is above rounding
/// any more, the estimate stays as it is and the rod creeps for ever. Nothing but the tangent
/// stiffness tells this from rest, so that who has factorised it corrects the estimate.
class ModeEstimate {
 public:
  ModeEstimate(const Rod& rod, const Eigen::Matrix3Xd& points);

  /// After a block of steps.
  /// @param inner_mode    bound of the fastest mode of contraction and bending [N/m]
  /// @param force_change  -dF.dP of the block [N m]
  /// @param point_change  dP.dP [m^2]. Those of the first call mean nothing.
  void update(double inner_mode, double force_change, double point_change);

  /// After a change of the rod's walls. The next update starts a new block: its changes mean
  /// nothing.
  void change_environment(const Rod& rod, const Eigen::Matrix3Xd& points);

  /// The same while steps without momentum are made: these move by the fast modes that they damp
  /// and by rounding, which say nothing of the slowest. The next update starts a new block.
  void update_fastest(double inner_mode);

  /// Begins anew with this stiffness where the estimate is far above it.
  /// @param slowest  of the tangent stiffness where the rod is; infinity: not known [N/m]
  void correct_slowest(double slowest);

  [[nodiscard]] const ModeBounds& modes() const { return modes_; }

 private:
  ModeBounds modes_;
  double constraints_ = 0;
  double rounding_ = 0;  // 2 N (eps x)^2 [m^2]
  double force_change_ = 0;
  double point_change_ = 0;
  bool block_open_ = false;
};

}  // namespace dlo::force_model
