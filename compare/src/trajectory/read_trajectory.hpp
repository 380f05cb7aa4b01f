#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "decode/csv_rows.hpp"
#include "dlo/compare/trajectory.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

/// The path from a pose of a Trajectory to the next, cubic in time.
struct TrajectoryLeg {
  Pose from, to;
  Eigen::Vector3d velocity_from, velocity_to;  ///< velocities at both poses [m/s]
  double angle = 0;  ///< angle between the directions [rad], if there are any
  /// Axis of that rotation, unit vector; zero without a rotation.
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  double rate_from = 0, rate_to = 0;  ///< rates of the rotation at both poses [rad/s]
  /// Rates of the roll at both poses [rad/s], if there is one.
  double roll_rate_from = 0, roll_rate_to = 0;

  /// Returns the position at a time from `from` to `to` [m], or its time derivative of order 1 or
  /// 2.
  [[nodiscard]] Eigen::Vector3d position(double time, int derivative = 0) const;
  /// Returns the angle of the rotation since `from` [rad], or its time derivative.
  [[nodiscard]] double turned(double time, int derivative = 0) const;
  /// Returns the roll [rad], if there is one, or its time derivative.
  [[nodiscard]] double rolled(double time, int derivative = 0) const;
};

/// Computes the leg from one pose to the next.
/// @param poses  as those of a Trajectory;  @param first  index of the leg's first pose, not the
/// last
[[nodiscard]] TrajectoryLeg leg_after(const std::vector<Pose>& poses, std::size_t first);

/// Keys of a moving object's poses in its table.
struct PoseKeys {
  const char* position = "position";  ///< key of the position
  /// Reads a pose's direction; empty: the object has neither direction nor roll.
  std::function<Eigen::Vector3d(StrictTable&)> direction;
  /// Arc length at which a gripper holds the rod [m]; the file of a clamp may then contain markers.
  /// Empty: the object is not a gripper.
  std::optional<double> at = std::nullopt;
};

/// Reads the poses of a table: [[..pose]] rows of time, position, direction and roll, or the file
/// that the key `trajectory` names (relative to the scene's folder), with poses or with two markers
/// on a gripper (poses_of_markers()), smoothed if the key `cutoff` is given (smooth_poses()).
/// Without either there are no poses. Either all rows have a direction or none has, likewise the
/// roll.
/// @throws InputError that names file, line, key and what is allowed
[[nodiscard]] Trajectory read_trajectory(StrictTable& table, const PoseKeys& keys,
                                         const std::string& scene_file);

/// Reads the text of the file that a table's key names (path_beside()). Only a regular file is
/// read, because a pipe or a device could block the reader.
/// @param allowed  "(allowed: ..)";  @throws InputError that names the key if there is no such file
[[nodiscard]] std::string read_referenced_file(const StrictTable& table, std::string_view key,
                                               const std::string& path, const char* allowed);

/// Reads poses from a CSV file: a header with time, x, y, z, (all or none) dx, dy, dz and
/// optionally roll, in any order, then a row per pose, in s, m and rad; empty lines and lines that
/// begin with # are skipped.
/// @throws InputError that names the file, the line, and what is allowed
[[nodiscard]] Trajectory parse_trajectory(std::string_view text, const std::string& file);

/// Computes the poses of a gripper from two markers on it; the rod is straight between and beyond
/// them. From the positions a and b of the markers at arc lengths s_1 < s_2 follows
///     direction = (b - a) / |b - a|,   position = (a + b) / 2 + (at - (s_1 + s_2) / 2) direction,
/// which is the least-squares fit to both. Each marker has its own times: between them its position
/// is that of its Trajectory. Poses are at the times, while both are observed, of the marker that
/// then has more rows.
/// @param at      arc length at which the gripper holds the rod [m]
/// @param cutoff  each marker is smoothed separately, as by smooth_poses() [Hz]; empty: not
/// smoothed
/// @throws InputError that names the file unless there are two markers, observed at the same time,
/// whose mean distance differs from that of their arc lengths by at most a fifth;
/// std::invalid_argument as smooth_poses()
[[nodiscard]] std::vector<Pose> poses_of_markers(const MarkerMotion& markers, double at,
                                                 std::optional<double> cutoff);

/// Smooths measured poses with a low-pass filter. Positions, directions (normalised again) and
/// rolls each minimise
///     sum w_k (x_k - y_k)^2 + lambda sum v_k (x''_k)^2,
/// x'' the second divided difference, w and v the time that a pose represents (Whittaker's
/// smoothing). The filter has no lag and does not change uniform motion. At equal steps h its gain
/// is that of a Butterworth filter of second order run forward and backward,
///     1 / (1 + (sqrt(2) - 1) (sin(pi f h) / sin(pi f_c h))^4):
/// 1/sqrt(2), or -3 dB, at the cut-off f_c.
/// @param poses   as those of a Trajectory, three or more
/// @param cutoff  [Hz], > 0, below half of their mean rate
/// @throws std::invalid_argument if these conditions do not hold, or smoothing leaves no direction
[[nodiscard]] std::vector<Pose> smooth_poses(std::vector<Pose> poses, double cutoff);

/// Columns of numbers of a CSV file, which its header has in any order.
class NumberColumns {
 public:
  /// @param names  columns that the file may have, in the order of numbers();  @param allowed
  /// "(allowed: ..)"
  /// @throws InputError that names file and line of another column, or of one that is given twice
  NumberColumns(const CsvRow& header, std::vector<std::string_view> names, const char* allowed);

  [[nodiscard]] bool has(std::size_t k) const { return of_[k].has_value(); }
  /// Checks that the file has the first `count` columns. @throws InputError
  void require(std::size_t count) const;
  /// Reads a row; a column that the file does not have is 0. Times and lengths have the limits of
  /// magnitude_problem().
  /// @throws InputError that names file, line, column and value
  [[nodiscard]] std::vector<double> numbers(const CsvRow& row) const;

 private:
  std::vector<std::string_view> names_;
  const char* allowed_;
  std::string where_;  // "file:line" of the header
  std::vector<std::optional<std::size_t>> of_;
  std::size_t count_;  // columns of the file
};

/// Reads a recording from CSV: a header with time, s, x, y, z in any order, then a row for each
/// marker that was observed at a time, in s and m. Rows may be in any order; the result is sorted
/// by time, then by arc length.
/// @throws InputError that names the file, the line, and what is allowed
[[nodiscard]] MarkerMotion parse_markers(std::string_view text, const std::string& file);

/// Whether the first row of a CSV text has a column.
[[nodiscard]] bool has_column(std::string_view text, std::string_view name);

}  // namespace dlo::compare
