#pragma once

#include <Eigen/Core>
#include <optional>

namespace dlo::force_model {

/// Way in which a grip holds its points.
enum class GripHold {
  rigid,   ///< positions are prescribed exactly, as in the energy model
  spring,  ///< each point is attached to a spring (Formula 5, constraint 3), as for a haptic device
};

/// Gripper that holds two consecutive points (position and direction) or one (position only).
struct Grip {
  Eigen::Index first_point = 0;  ///< index of the first held point
  Eigen::Matrix3Xd targets;      ///< prescribed positions of its points [m], 3 x 1 or 3 x 2
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();  ///< reference point of its torque [m]
  GripHold hold = GripHold::rigid;                      ///< rigid or by springs
  double stiffness = 0;                                 ///< c_e of a `spring` hold [N/m], > 0
  /// First director of the rod's material frame at the held segment, of which the component across
  /// the segment is used. It keeps a round rod from rotating about its tangent there, see
  /// TwistedSpan. It requires two points and hold `rigid`. Empty: the twist is free.
  std::optional<Eigen::Vector3d> d1 = {};
};

/// Force and torque of a gripper on the rod; a hand that holds the gripper feels the opposite.
struct GripReaction {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N]
  /// Torque about Grip::reference, including the twisting moment of a grip that holds the frame [N
  /// m].
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
};

/// Returns the targets of a two-point grip: the points at distances 0 and `segment_length` along
/// the unit vector t of `direction` from `position - behind * t`.
/// @param position   position of the gripper [m]
/// @param direction  direction of growing point index, any length > 0 [-]
/// @param segment_length  distance of the two points [m], > 0
/// @param behind     distance of the first point behind the gripper [m]: 0, or segment_length / 2
///                   for a gripper that holds the middle of the segment
/// @throws std::invalid_argument if a number is out of range
[[nodiscard]] Eigen::Matrix3Xd grip_targets(const Eigen::Vector3d& position,
                                            const Eigen::Vector3d& direction, double segment_length,
                                            double behind);

}  // namespace dlo::force_model
