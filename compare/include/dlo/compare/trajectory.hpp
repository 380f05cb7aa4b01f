#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace dlo::compare {

/// Where something is at a time, and which way it points.
struct Pose {
  double time = 0;                                     ///< [s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  std::optional<Eigen::Vector3d> direction;            ///< unit; of what has one
  std::optional<double> roll;  ///< about the direction, of a clamp that has one [rad]

  /// In every field.
  bool operator==(const Pose&) const = default;
};

/// Position of one marker on the rod at one time.
struct MarkerPosition {
  double time = 0;                                     ///< [s]
  double arc_length = 0;                               ///< of the marker [m]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
};

/// A recorded motion.
struct MarkerMotion {
  std::string file;                       ///< for messages
  std::vector<MarkerPosition> positions;  ///< by time, then by arc length; one or more
};

/// A smooth way through poses; nothing moves before the first and after the last of them, where it
/// begins and ends at rest.
///
/// Positions are cubic in time between two poses (Hermite), with continuous velocity. At a pose
/// between others the velocity is that of the parabola through it and its neighbours,
///     v_k = (h_+ s_- + h_- s_+) / (h_- + h_+),   s = change of position / h of either side,
/// but no faster than three times the slower side, and zero where the way turns back (s_- . s_+ <=
/// 0). So what moves along a line does not go beyond a pose and come back (Fritsch and Carlson,
/// SIAM J. Numer. Anal. 17, 1980), and a pose that is given twice is held. The way does not depend
/// on the axes.
///
/// Directions go along the great circle from pose to pose; the angle on it is cubic in time in the
/// same way, and stands still for a moment at a pose where two great circles meet at an angle, so
/// that the rate of turning is continuous too. Rolls are cubic as positions along a line are.
class Trajectory {
 public:
  /// Stands where it is; has no poses.
  Trajectory() = default;
  /// @param poses  by growing time, one or more; either all or none has a direction, likewise a
  /// roll, and no direction is opposite to the one before
  /// @throws std::invalid_argument naming the pose if that is not so, or a number is not finite
  explicit Trajectory(std::vector<Pose> poses);

  [[nodiscard]] bool empty() const { return poses_.empty(); }              ///< No poses.
  [[nodiscard]] const std::vector<Pose>& poses() const { return poses_; }  ///< By growing time.
  [[nodiscard]] double begin() const { return poses_.front().time; }       ///< Of the first [s].
  [[nodiscard]] double end() const { return poses_.back().time; }          ///< Of the last [s].
  /// At any time, of a trajectory that has poses.
  [[nodiscard]] Pose pose_at(double time) const;

  /// In every pose.
  bool operator==(const Trajectory&) const = default;

 private:
  std::vector<Pose> poses_;
};

}  // namespace dlo::compare
