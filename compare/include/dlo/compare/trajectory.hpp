#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace dlo::compare {

/// Position and direction at one time.
struct Pose {
  double time = 0;                                     ///< [s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  /// Unit vector; empty for an object without a direction.
  std::optional<Eigen::Vector3d> direction;
  std::optional<double> roll;  ///< about the direction [rad]; only of a clamp with a roll

  /// Compares all fields.
  bool operator==(const Pose&) const = default;
};

/// Position of one marker on the rod at one time.
struct MarkerPosition {
  double time = 0;                                     ///< [s]
  double arc_length = 0;                               ///< arc length of the marker [m]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
};

/// A recorded motion of markers on a rod.
struct MarkerMotion {
  std::string file;                       ///< name of the file, for messages
  std::vector<MarkerPosition> positions;  ///< by time, then by arc length; one or more
};

/// A smooth path through poses. It begins and ends at rest, and does not move before the first pose
/// and after the last.
///
/// Positions are cubic in time between two poses (Hermite), with continuous velocity. At an inner
/// pose the velocity is that of the parabola through it and its neighbours,
///     v_k = (h_+ s_- + h_- s_+) / (h_- + h_+),   s = change of position / h of either side,
/// but at most three times that of the slower side, and zero if the path reverses (s_- . s_+ <= 0).
/// Motion along a line therefore does not overshoot a pose (Fritsch and Carlson, SIAM J. Numer.
/// Anal. 17, 1980), and a pose that is given twice is held between the two times. The path does not
/// depend on the axes.
///
/// Directions follow the great circle from pose to pose. The angle on it is cubic in time in the
/// same way; its rate is zero at a pose where two great circles meet at an angle, so that the
/// angular velocity is continuous too. Rolls are cubic in time like positions along a line.
class Trajectory {
 public:
  /// Constructs a trajectory without poses, of something that does not move.
  Trajectory() = default;
  /// Constructs a path through poses.
  /// @param poses  one or more, by increasing time; either all or none has a direction, likewise a
  /// roll. Directions need not be unit vectors; none is zero or opposite to the one before
  /// @throws std::invalid_argument that names the pose if this does not hold, or if a number is not
  /// finite
  explicit Trajectory(std::vector<Pose> poses);

  [[nodiscard]] bool empty() const { return poses_.empty(); }  ///< Whether there are no poses.
  [[nodiscard]] const std::vector<Pose>& poses() const { return poses_; }  ///< By time.
  [[nodiscard]] double begin() const { return poses_.front().time; }       ///< First time [s].
  [[nodiscard]] double end() const { return poses_.back().time; }          ///< Last time [s].
  /// Returns the pose at any time [s]. This function, begin() and end() need one pose or more.
  [[nodiscard]] Pose pose_at(double time) const;

  /// Compares all poses.
  bool operator==(const Trajectory&) const = default;

 private:
  std::vector<Pose> poses_;
};

}  // namespace dlo::compare
