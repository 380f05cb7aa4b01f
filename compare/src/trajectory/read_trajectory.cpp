#include "trajectory/read_trajectory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "base/input_file.hpp"
#include "base/number.hpp"
#include "base/quote.hpp"
#include "decode/csv_rows.hpp"
#include "dlo/compare/error.hpp"
#include "trajectory/trajectory_files.hpp"

namespace dlo::compare {
namespace {

/// Largest number of poses, more than a robot's program has; a pose takes about a hundred bytes.
constexpr std::size_t most_poses = 1'000'000;

constexpr std::array<const char*, 8> pose_columns = {"time", "x",  "y",  "z",
                                                     "dx",   "dy", "dz", "roll"};
constexpr std::size_t direction_columns = 4, roll_column = 7;  // index of the first column
constexpr const char* pose_columns_allowed =
    "(allowed: a header of time,x,y,z with or without dx,dy,dz and roll, in any order)";
constexpr const char* file_allowed =
    "(allowed: a CSV file with the columns time,x,y,z with or without dx,dy,dz and roll, or, of "
    "two "
    "markers on a gripper, time,s,x,y,z)";

/// Returns the problem of a pose in Trajectory's message, without the name of the class.
std::string problem_in(const std::invalid_argument& error) {
  const std::string_view message = error.what();
  const std::size_t name = message.find(": ");
  return std::string(message.substr(name == std::string_view::npos ? 0 : name + 2));
}

/// Position of each of pose_columns among a file's columns.
struct PoseColumns {
  std::size_t count = 0;
  std::array<std::optional<std::size_t>, pose_columns.size()> of;

  [[nodiscard]] bool has_direction() const { return of[4].has_value(); }
};

PoseColumns pose_columns_of(const std::vector<std::string_view>& fields, const std::string& where) {
  PoseColumns columns{.count = fields.size(), .of = {}};
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const auto* const found = std::find(pose_columns.begin(), pose_columns.end(), fields[i]);
    if (found == pose_columns.end()) {
      throw InputError(fmt::format("{}: unknown column {} {}", where, quoted_piece(fields[i]),
                                   pose_columns_allowed));
    }
    auto& of = columns.of[static_cast<std::size_t>(found - pose_columns.begin())];
    if (of) throw InputError(fmt::format("{}: column {} given twice", where, *found));
    of = i;
  }
  const bool direction = columns.of[4] || columns.of[5] || columns.of[6];
  for (std::size_t k = 0; k < (direction ? roll_column : direction_columns); ++k) {
    if (columns.of[k]) continue;
    throw InputError(
        fmt::format("{}: column {} is missing {}", where, pose_columns[k], pose_columns_allowed));
  }
  return columns;
}

Dimension pose_dimension(std::size_t column) {
  if (column == 0) return Dimension::time;
  return column < 4 ? Dimension::length : Dimension::number;
}

Pose pose_of(const std::vector<std::string_view>& fields, const PoseColumns& columns,
             const std::string& where) {
  if (fields.size() != columns.count) {
    throw InputError(fmt::format("{}: {} column{} (allowed: {}, as in the header)", where,
                                 fields.size(), fields.size() == 1 ? "" : "s", columns.count));
  }
  std::array<double, pose_columns.size()> values{};
  for (std::size_t k = 0; k < pose_columns.size(); ++k) {
    if (!columns.of[k]) continue;
    const std::string_view field = fields[*columns.of[k]];
    const std::optional<double> value = as_number<double>(field);
    if (!value || !std::isfinite(*value)) {
      throw InputError(
          fmt::format("{}: {} = {} is not a number (allowed: finite numbers in s, m, rad)", where,
                      pose_columns[k], quoted_piece(field)));
    }
    const std::string problem = magnitude_problem(*value, pose_dimension(k));
    if (!problem.empty()) {
      throw InputError(fmt::format("{}: {} = {:g}: {}", where, pose_columns[k], *value, problem));
    }
    values[k] = *value;
  }
  Pose pose{values[0], {values[1], values[2], values[3]}, std::nullopt, std::nullopt};
  if (columns.has_direction()) pose.direction = Eigen::Vector3d(values[4], values[5], values[6]);
  if (columns.of[roll_column]) pose.roll = values[roll_column];
  return pose;
}

Trajectory read_rows(StrictTable& table, std::vector<StrictTable>& rows, const PoseKeys& keys) {
  std::vector<Pose> poses;
  std::vector<std::string> allowed{keys.position, "time"};
  if (keys.direction) allowed.insert(allowed.end(), {"direction", "roll"});
  for (StrictTable& row : rows) {
    row.only(allowed);
    Pose pose;
    pose.time = row.number("time", Dimension::time, Range::any());
    pose.position = row.vector(keys.position, Dimension::length);
    if (keys.direction && row.has("direction")) pose.direction = keys.direction(row);
    if (keys.direction) pose.roll = row.optional_number("roll", Dimension::angle, Range::any());
    row.finish();
    const auto wrong = [&](const char* key, const char* problem) { row.fail(key, problem); };
    if (!poses.empty()) {
      if (!(pose.time > poses.back().time)) {
        wrong("time", "not above that of the pose before (allowed: growing times)");
      }
      if (pose.direction.has_value() != poses.front().direction.has_value()) {
        wrong("direction", "given for some poses only (allowed: for all of them or for none)");
      }
      if (pose.roll.has_value() != poses.front().roll.has_value()) {
        wrong("roll", "given for some poses only (allowed: for all of them or for none)");
      }
    }
    poses.push_back(std::move(pose));
  }
  try {
    return Trajectory(std::move(poses));
  } catch (const std::invalid_argument& error) {
    table.fail("pose", problem_in(error));
  }
}

/// Whether a file's rows are those of markers, which have arc lengths.
bool is_of_markers(std::string_view text, const std::string& file) {
  bool found = false;
  for_each_csv_row(text, file, {.most_rows = 1}, [&found](const CsvRow& row) {
    found = std::ranges::find(row.fields, "s") != row.fields.end();
  });
  return found;
}

/// Reads the poses of a file. @throws std::invalid_argument as smooth_poses()
std::vector<Pose> file_poses(const std::string& text, const std::string& file, const PoseKeys& keys,
                             std::optional<double> cutoff) {
  if (keys.at && is_of_markers(text, file)) {
    return poses_of_markers(parse_markers(text, file), *keys.at, cutoff);
  }
  const Trajectory given = parse_trajectory(text, file);
  return cutoff ? smooth_poses(given.poses(), *cutoff) : given.poses();
}

}  // namespace

std::string read_beside(const StrictTable& table, std::string_view key, const std::string& path,
                        const char* allowed) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) {
    const bool is_there = std::filesystem::exists(path, unknown);
    table.fail(
        key, fmt::format("{} {}", is_there ? "not a regular file" : "no such file beside the scene",
                         allowed));
  }
  return read_file(path);
}

Trajectory parse_trajectory(std::string_view text, const std::string& file) {
  std::optional<PoseColumns> columns;
  std::vector<Pose> poses;
  for_each_csv_row(text, file, {}, [&](const CsvRow& row) {
    if (!columns) {
      columns = pose_columns_of(row.fields, row.where);
      return;
    }
    if (poses.size() == most_poses) {
      throw InputError(fmt::format("{}: more than {} poses", row.where, most_poses));
    }
    poses.push_back(pose_of(row.fields, *columns, row.where));
    if (poses.size() > 1 && !(poses.back().time > poses[poses.size() - 2].time)) {
      throw InputError(fmt::format("{}: time = {} is not above that of the row before", row.where,
                                   poses.back().time));
    }
  });
  if (poses.empty()) throw InputError(fmt::format("{}: no poses {}", file, pose_columns_allowed));
  try {
    return Trajectory(std::move(poses));
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", file, problem_in(error)));
  }
}

Trajectory read_trajectory(StrictTable& table, const PoseKeys& keys,
                           const std::string& scene_file) {
  std::vector<StrictTable> rows = table.tables("pose");
  const std::optional<std::string> name = table.optional_text("trajectory");
  if (name && !rows.empty()) {
    table.fail("trajectory", "given besides poses (allowed: one of trajectory and [[..pose]])");
  }
  const std::optional<double> cutoff =
      table.optional_number("cutoff", Dimension::frequency, Range::positive());
  if (cutoff && !name) {
    table.fail("cutoff", "given without a file of poses (allowed: beside trajectory)");
  }
  if (!name) return rows.empty() ? Trajectory() : read_rows(table, rows, keys);
  Trajectory trajectory;
  try {
    const std::string text =
        read_beside(table, "trajectory", path_beside(*name, scene_file), file_allowed);
    trajectory = Trajectory(file_poses(text, *name, keys, cutoff));
  } catch (const InputError& error) {
    // The table's own errors name the position already.
    if (std::string_view(error.what()).starts_with(scene_file)) throw;
    table.fail("trajectory", error.what());
  } catch (const std::invalid_argument& error) {
    table.fail(cutoff ? "cutoff" : "trajectory", problem_in(error));
  }
  if (trajectory.poses().front().direction && !keys.direction) {
    table.fail("trajectory", "has directions (allowed here: time,x,y,z)");
  }
  if (trajectory.poses().front().roll && !keys.direction) {
    table.fail("trajectory", "has rolls (allowed here: time,x,y,z)");
  }
  return trajectory;
}

}  // namespace dlo::compare
