#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>

namespace dlo::energy_model {

/// Pose of a grip at one time, with its velocities and accelerations.
struct GripPose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< derivative of the position by time [m/s]
  /// Second derivative of the position [m/s^2].
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
  /// Rotation of a clamp from Grip::direction [-].
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  /// Angular velocity in the axes of space [rad/s].
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();
  /// Derivative of the angular velocity [rad/s^2].
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();
};

/// Pose as a function of time [s]. Positions and rotations have to be continuous, and so have their
/// velocities except at MovingRod::breaks.
using GripMotion = std::function<GripPose(double time)>;

/// A function of time with two derivatives.
struct MotionValue {
  double value = 0;         ///< [m] or [rad]
  double rate = 0;          ///< first derivative by time
  double acceleration = 0;  ///< second derivative by time
};

/// Returns the motion of a grip that stays at a position.
[[nodiscard]] GripMotion fixed_grip(const Eigen::Vector3d& position);

/// Returns the motion of a grip that moves along an axis and rotates about another axis through its
/// own position.
/// @param position  position at distance zero [m]
/// @param along     axis of the translation, any length > 0
/// @param about     axis of the rotation, any length > 0
/// @param distance  distance along the first axis [m] by time [s]; null: the grip does not move
/// @param angle     angle about the second axis [rad] by time [s]; null: the grip does not rotate
/// @throws std::invalid_argument if the axis of a function that is not null has no length
[[nodiscard]] GripMotion moving(const Eigen::Vector3d& position, const Eigen::Vector3d& along,
                                std::function<MotionValue(double)> distance,
                                const Eigen::Vector3d& about,
                                std::function<MotionValue(double)> angle);

/// Returns a function that grows from 0 to `size` between two times. It is the polynomial of degree
/// seven whose first three derivatives vanish at both times, so that its jerk is continuous.
/// @throws std::invalid_argument unless begin < end
[[nodiscard]] std::function<MotionValue(double)> smooth_step(double begin, double end, double size);

}  // namespace dlo::energy_model
