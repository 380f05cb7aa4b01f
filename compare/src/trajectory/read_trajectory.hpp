#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dlo/compare/trajectory.hpp"
#include "toml/strict_table.hpp"

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

/// What the poses of a table's moving thing have.
struct PoseKeys {
  const char* position = "position";  ///< key of where it is
  /// Reads a pose's direction; none: it has no direction, and no roll.
  std::function<Eigen::Vector3d(StrictTable&)> direction;
  /// Arc length at which it holds the rod [m], whose file may be of markers; none: it is no
  /// gripper.
  std::optional<double> at = std::nullopt;
};

/// The poses of a table, as [[..pose]] rows of time, position, direction and roll, or as the file
/// that its key `trajectory` names (relative to the scene's folder), of poses or of two markers on
/// a gripper (poses_of_markers()): none of the two is no poses.
/// Rows may all leave the direction out, and the roll. @throws InputError naming file, line, key
/// and what is allowed
[[nodiscard]] Trajectory read_trajectory(StrictTable& table, const PoseKeys& keys,
                                         const std::string& scene_file);

/// Text of the file that a table's key names, relative to the folder of the scene; a pipe or a
/// device could keep a scene from ever being read.
/// @param allowed  "(allowed: ..)";  @throws InputError naming the key if there is no such file
[[nodiscard]] std::string read_beside(const StrictTable& table, std::string_view key,
                                      const std::string& name, const std::string& scene_file,
                                      const char* allowed);

/// Poses of a CSV file: a header with time, x, y, z, (all or none) dx, dy, dz and perhaps roll, in
/// any order, then a row a pose, in s, m and rad; empty lines and those that begin with # are
/// passed over.
/// @throws InputError naming the file, the line, and what is allowed
[[nodiscard]] Trajectory parse_trajectory(std::string_view text, const std::string& file);

/// Poses of a gripper that two markers on it show, the rod straight between and beyond them: of
/// those at arc lengths s_1 < s_2 seen at a and b it is
///     direction = (b - a) / |b - a|,   position = (a + b) / 2 + (at - (s_1 + s_2) / 2) direction,
/// which comes nearest to both (least squares). Each marker has its own times: where one was not
/// seen it is on its Trajectory. Poses are at the times of that with more rows, while both are
/// seen.
/// @param at      where the gripper holds the rod [m]
/// @param cutoff  each marker is smoothed by itself, as by smooth_poses() [Hz]; none: not
/// @throws InputError naming the file unless there are two markers, seen at the same time, and on
/// average as far apart as their arc lengths, to a fifth; std::invalid_argument as smooth_poses()
[[nodiscard]] std::vector<Pose> poses_of_markers(const MarkerMotion& markers, double at,
                                                 std::optional<double> cutoff);

/// Poses that were measured, without what is faster than a cut-off: positions, directions (of norm
/// 1 again) and rolls each by the least sum
///     sum w_k (x_k - y_k)^2 + lambda sum v_k (x''_k)^2,
/// x'' the second divided difference, w and v the time that a pose stands for (Whittaker's
/// smoothing). It has no lag, keeps what moves evenly, and at equal steps h its gain is that of a
/// Butterworth filter of second order run forward and backward,
///     1 / (1 + (sqrt(2) - 1) (sin(pi f h) / sin(pi f_c h))^4):
/// 1/sqrt(2), or -3 dB, at the cut-off f_c.
/// @param poses   as Trajectory's, three or more
/// @param cutoff  [Hz], > 0, below half of their mean rate
/// @throws std::invalid_argument if that is not so, or smoothing leaves no direction
[[nodiscard]] std::vector<Pose> smooth_poses(std::vector<Pose> poses, double cutoff);

/// A recording as CSV: a header with time, s, x, y, z in any order, then a row for each marker that
/// was seen at a time, in s and m; a marker that was not seen has none. Rows may come in any order.
/// @throws InputError naming the file, the line, and what is allowed
[[nodiscard]] MarkerMotion parse_markers(std::string_view text, const std::string& file);

/// Whether the first row of a CSV text is the header of a recording.
[[nodiscard]] bool has_marker_columns(std::string_view text, const std::string& file);

}  // namespace dlo::compare
