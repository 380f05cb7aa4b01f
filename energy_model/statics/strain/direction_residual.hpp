#pragma once

#include <Eigen/Core>

namespace dlo::energy_model {

/// Residual of a director p that is prescribed as `to`, in its component along `across`, which is
/// normal to `to`,
///     c = 2 across.p / (1 + to.p).
/// It is approximately the angle, and with both components zero only at p = to. A rotation vector
/// theta of p changes it by couple . theta + theta . curvature theta / 2.
struct DirectionResidual {
  double value = 0;
  Eigen::Vector3d couple = Eigen::Vector3d::Zero();
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();
};

[[nodiscard]] DirectionResidual direction_residual(const Eigen::Vector3d& p,
                                                   const Eigen::Vector3d& to,
                                                   const Eigen::Vector3d& across);

}  // namespace dlo::energy_model
