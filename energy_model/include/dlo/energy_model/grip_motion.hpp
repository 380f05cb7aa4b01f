#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <vector>

namespace dlo::energy_model {

/// Where a grip is at one time, and how it moves.
struct GripPose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      ///< its derivative by time [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< its second derivative [m/s^2]
  /// By which a clamp has turned from Grip::direction [-].
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();      ///< of the turn, in space [1/s]
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  ///< its derivative [1/s^2]
};

/// Poses by time [s]. Positions and turns have to be continuous, and so have to be their velocities
/// but at MovingRod::breaks.
using GripMotion = std::function<GripPose(double time)>;

/// A function of time with two derivatives.
struct MotionValue {
  double value = 0;         ///< [m] or [rad]
  double rate = 0;          ///< by time
  double acceleration = 0;  ///< by time, twice
};

/// A grip that stays where it is.
[[nodiscard]] GripMotion standing(const Eigen::Vector3d& position);

/// A grip that moves along an axis and rotates about another one through its own position.
/// @param position  where the distance is zero [m]
/// @param along     any length > 0
/// @param about     any length > 0
/// @param distance  along it [m] by time [s]; null: stays
/// @param angle     about it [rad] by time [s]; null: does not rotate
/// @throws std::invalid_argument if an axis has no length
[[nodiscard]] GripMotion moving(const Eigen::Vector3d& position, const Eigen::Vector3d& along,
                                std::function<MotionValue(double)> distance,
                                const Eigen::Vector3d& about,
                                std::function<MotionValue(double)> angle);

/// From 0 to `size` between two times, with the polynomial of degree seven whose first three
/// derivatives vanish at both: jerk is continuous.
/// @throws std::invalid_argument unless begin < end
[[nodiscard]] std::function<MotionValue(double)> smooth_step(double begin, double end, double size);

/// A grip's pose at one time, of a table.
struct TimedPose {
  double time = 0;                                           ///< [s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();        ///< [m]
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< from Grip::direction [-]
};

/// Poses between those of a table: positions by the cubic spline that stands at both ends,
/// turns along great circles, with quintic blending that stops at each row.
/// The times of the table have to be among MovingRod::breaks, because accelerations have kinks
/// there.
/// @throws std::invalid_argument unless there are two rows or more, by growing time
[[nodiscard]] GripMotion interpolated(std::vector<TimedPose> poses);

}  // namespace dlo::energy_model
