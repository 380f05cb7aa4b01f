#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "dlo/compare/trajectory.hpp"

namespace dlo::compare {

/// The way from a pose of a Trajectory to the next, cubic in time.
struct TrajectoryLeg {
  Pose from, to;
  Eigen::Vector3d velocity_from, velocity_to;  ///< at both [m/s]
  double angle = 0;                            ///< between the directions, of what has some [rad]
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();  ///< of that turn, unit; zero without one
  double rate_from = 0, rate_to = 0;               ///< of rotating about it, at both [rad/s]
  double roll_rate_from = 0, roll_rate_to = 0;     ///< of the roll, of what has one [rad/s]

  /// At a time from `from` to `to` [m], or a derivative of it by time: 0 to 2.
  [[nodiscard]] Eigen::Vector3d position(double time, int derivative = 0) const;
  /// The angle turned since `from` [rad], or a derivative.
  [[nodiscard]] double turned(double time, int derivative = 0) const;
  /// The roll, of what has one [rad], or a derivative.
  [[nodiscard]] double rolled(double time, int derivative = 0) const;
};

/// @param poses  as a Trajectory has them;  @param first  of the leg, not the last pose
[[nodiscard]] TrajectoryLeg leg_after(const std::vector<Pose>& poses, std::size_t first);

}  // namespace dlo::compare
