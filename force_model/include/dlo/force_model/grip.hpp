#pragma once

#include <Eigen/Core>
#include <optional>

namespace dlo::force_model {

/// How a grip holds its points.
enum class GripHold {
  rigid,   ///< positions are prescribed: what comparisons use
  spring,  ///< each point hangs on a spring (Formula 5, constraint 3): what a haptic device feels
};

/// A gripper: two neighbouring points (position and direction) or one (position only).
struct Grip {
  Eigen::Index first_point = 0;  ///< index of the first point held
  Eigen::Matrix3Xd targets;      ///< where its points are held [m], 3 x 1 or 3 x 2
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();  ///< torques are taken about this point [m]
  GripHold hold = GripHold::rigid;                      ///< rigid, or springs
  double stiffness = 0;                                 ///< c_e of a `spring` hold [N/m], > 0
  /// First director of the rod's material frame at the segment held, of which the part across the
  /// segment counts: keeps a round rod from rotating about itself there, see TwistedSpan. Two
  /// points and hold `rigid` only. None: the twist is free.
  std::optional<Eigen::Vector3d> d1 = {};
};

/// What a gripper exerts on the rod; a hand that holds it feels the opposite.
struct GripReaction {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N]
  /// About Grip::reference, with the twisting moment of a grip that holds the frame [N m].
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
};

/// Targets of a two-point grip: the points at distances `behind` and `behind + segment_length`
/// along `direction`, counted from `position - behind * direction`.
/// @param position   where the gripper is [m]
/// @param direction  along growing point index, any length > 0 [-]
/// @param segment_length  distance of the two points [m], > 0
/// @param behind     how far the first point lies behind the gripper [m]: 0, or segment_length / 2
///                   for a gripper that holds the middle of the segment
/// @throws std::invalid_argument if a number is out of range
[[nodiscard]] Eigen::Matrix3Xd grip_targets(const Eigen::Vector3d& position,
                                            const Eigen::Vector3d& direction, double segment_length,
                                            double behind);

}  // namespace dlo::force_model
