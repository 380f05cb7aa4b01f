#pragma once

#include <Eigen/Core>

#include "dlo/force_model/step_size.hpp"

namespace dlo::force_model {

/// The fastest mode's bound in the present shape and an estimate of the slowest mode that still
/// moves, -dF.dP / dP.dP over blocks of steps, older blocks fading out.
class ModeEstimate {
 public:
  ModeEstimate(const Rod& rod, const Eigen::Matrix3Xd& points);

  /// After a block of steps. Allocates nothing.
  /// @param forces  on the free points [N], zero on rigidly held ones
  void update(const Rod& rod, const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& forces);

  [[nodiscard]] const ModeBounds& modes() const { return modes_; }
  [[nodiscard]] double slowest_expected() const { return slowest_expected_; }

 private:
  ModeBounds modes_;
  double slowest_expected_ = 0;  // before anything moved
  Eigen::Matrix3Xd last_points_;
  Eigen::Matrix3Xd last_forces_;
  double force_change_ = 0;
  double point_change_ = 0;
  bool has_last_ = false;
};

}  // namespace dlo::force_model
