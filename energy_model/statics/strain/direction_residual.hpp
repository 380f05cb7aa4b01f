#pragma once

#include <Eigen/Core>

namespace dlo::energy_model {

/// Residual of a director p that is held in the direction `to`, in the component along `across`,
/// which is at right angles to it,
///     c = 2 across.p / (1 + to.p):
/// about the angle, and zero at p = to alone. A turn theta of p, a rotation vector, changes it by
/// couple . theta + theta . curvature theta / 2.
struct DirectionResidual {
  double value = 0;
  Eigen::Vector3d couple = Eigen::Vector3d::Zero();
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();
};

[[nodiscard]] DirectionResidual direction_residual(const Eigen::Vector3d& p,
                                                   const Eigen::Vector3d& to,
                                                   const Eigen::Vector3d& across);

}  // namespace dlo::energy_model
