#pragma once

#include <Eigen/Core>

#include "dlo/energy_model/problem.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {

/// A rod with directors that are fixed to its material, curved by nature or of two bending
/// stiffnesses, with all of its grips: torque passes through clamps that do not
/// hold the frame, so it is not cut. In the axes of the frame that the first clamp holds, in units
/// of l, EI/l, EI/l^2.
struct CurvedRod {
  RodSpan span;           ///< all of the rod; the frame that its first clamp holds is 1
  double first_roll = 0;  ///< of that frame, which it contains [rad]
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< in space
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();    ///< where positions are zero [m]
  double length = 1;                                   ///< [m]

  /// Whether a shape without spins out of its plane across axis 2 is one of its shapes.
  [[nodiscard]] bool planar() const;
};

/// @throws std::invalid_argument if the problem is out of range, or the frame of its first clamp is
/// not known
[[nodiscard]] CurvedRod make_curved_rod(const Problem& problem);

}  // namespace dlo::energy_model
