#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dlo/compare/trajectory.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

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

}  // namespace dlo::compare
