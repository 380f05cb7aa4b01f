#include "trajectory/read_trajectory.hpp"

#include <fmt/format.h>

#include <algorithm>
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

constexpr std::size_t first_of_direction = 4, roll_column = 7;  // index of the first column
constexpr const char* pose_columns_allowed =
    "(allowed: a header of time,x,y,z with or without dx,dy,dz and roll, in any order)";
constexpr const char* file_allowed =
    "(allowed: a CSV file with the columns time,x,y,z with or without dx,dy,dz and roll, or, of "
    "two "
    "markers on a gripper, time,s,x,y,z)";

/// Returns the message of Trajectory or smooth_poses() without that name.
std::string problem_of_pose(const std::invalid_argument& error) {
  const std::string_view message = error.what();
  const std::size_t name = message.find(": ");
  return std::string(message.substr(name == std::string_view::npos ? 0 : name + 2));
}

Trajectory read_rows(StrictTable& table, std::vector<StrictTable>& rows, const PoseKeys& keys) {
  std::vector<Pose> poses;
  for (StrictTable& row : rows) {
    Pose pose;
    pose.time = row.number("time");
    pose.position = row.vector(keys.position);
    if (keys.direction && row.has("direction")) pose.direction = keys.direction(row);
    if (keys.direction) row.read("roll", pose.roll);
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
    table.fail("pose", problem_of_pose(error));
  }
}

/// Reads the poses of a file. @throws std::invalid_argument as smooth_poses()
std::vector<Pose> file_poses(const std::string& text, const std::string& file, const PoseKeys& keys,
                             std::optional<double> cutoff) {
  // Only markers have arc lengths.
  if (keys.at && has_column(text, "s")) {
    return poses_of_markers(parse_markers(text, file), *keys.at, cutoff);
  }
  const Trajectory given = parse_trajectory(text, file);
  return cutoff ? smooth_poses(given.poses(), *cutoff) : given.poses();
}

}  // namespace

std::string read_referenced_file(const StrictTable& table, std::string_view key,
                                 const std::string& path, const char* allowed) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) {
    const bool is_file = std::filesystem::exists(path, unknown);
    table.fail(
        key, fmt::format("{} {}", is_file ? "not a regular file" : "no such file beside the scene",
                         allowed));
  }
  try {
    return read_file(path);
  } catch (const InputError& error) {
    table.fail(key, error.what());
  }
}

NumberColumns::NumberColumns(const CsvRow& header, std::vector<std::string_view> names,
                             const char* allowed)
    : names_(std::move(names)),
      allowed_(allowed),
      where_(header.where),
      of_(names_.size()),
      count_(header.fields.size()) {
  for (std::size_t i = 0; i < count_; ++i) {
    const auto found = std::ranges::find(names_, header.fields[i]);
    if (found == names_.end()) {
      throw InputError(fmt::format("{}: unknown column {} {}", where_,
                                   quoted_piece(header.fields[i]), allowed_));
    }
    auto& of = of_[static_cast<std::size_t>(found - names_.begin())];
    if (of) throw InputError(fmt::format("{}: column {} given twice", where_, *found));
    of = i;
  }
}

void NumberColumns::require(std::size_t count) const {
  for (std::size_t k = 0; k < count; ++k) {
    if (has(k)) continue;
    throw InputError(fmt::format("{}: column {} is missing {}", where_, names_[k], allowed_));
  }
}

std::vector<double> NumberColumns::numbers(const CsvRow& row) const {
  if (row.fields.size() != count_) {
    throw InputError(fmt::format("{}: {} column{} (allowed: {}, as in the header)", row.where,
                                 row.fields.size(), row.fields.size() == 1 ? "" : "s", count_));
  }
  std::vector<double> values(names_.size());
  for (std::size_t k = 0; k < names_.size(); ++k) {
    if (!has(k)) continue;
    const std::string_view field = row.fields[*of_[k]];
    const std::optional<double> value = as_number<double>(field);
    if (!value || !std::isfinite(*value)) {
      throw InputError(
          fmt::format("{}: {} = {} is not a number (allowed: finite numbers in s, m, rad)",
                      row.where, names_[k], quoted_piece(field)));
    }
    const Dimension dimension = names_[k] == "time"     ? Dimension::time
                                : names_[k].size() == 1 ? Dimension::length
                                                        : Dimension::number;
    if (const std::string problem = magnitude_problem(*value, dimension); !problem.empty()) {
      throw InputError(fmt::format("{}: {} = {:g}: {}", row.where, names_[k], *value, problem));
    }
    values[k] = *value;
  }
  return values;
}

Trajectory parse_trajectory(std::string_view text, const std::string& file) {
  std::optional<NumberColumns> columns;
  std::vector<Pose> poses;
  for_each_csv_row(text, file, {}, [&](const CsvRow& row) {
    if (!columns) {
      columns.emplace(
          row, std::vector<std::string_view>{"time", "x", "y", "z", "dx", "dy", "dz", "roll"},
          pose_columns_allowed);
      const bool direction = columns->has(4) || columns->has(5) || columns->has(6);
      columns->require(direction ? roll_column : first_of_direction);
      return;
    }
    if (poses.size() == most_poses) {
      throw InputError(fmt::format("{}: more than {} poses", row.where, most_poses));
    }
    const std::vector<double> v = columns->numbers(row);
    if (!poses.empty() && !(v[0] > poses.back().time)) {
      throw InputError(
          fmt::format("{}: time = {} is not above that of the row before", row.where, v[0]));
    }
    poses.push_back({v[0], {v[1], v[2], v[3]}, std::nullopt, std::nullopt});
    if (columns->has(first_of_direction)) poses.back().direction = {v[4], v[5], v[6]};
    if (columns->has(roll_column)) poses.back().roll = v[roll_column];
  });
  if (poses.empty()) throw InputError(fmt::format("{}: no poses {}", file, pose_columns_allowed));
  try {
    return Trajectory(std::move(poses));
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", file, problem_of_pose(error)));
  }
}

Trajectory read_trajectory(StrictTable& table, const PoseKeys& keys,
                           const std::string& scene_file) {
  std::vector<StrictTable> rows = table.tables("pose");
  const std::optional<std::string> name = table.optional_text("trajectory");
  std::optional<double> cutoff;
  table.read("cutoff", cutoff);
  if (!name) return rows.empty() ? Trajectory() : read_rows(table, rows, keys);
  const std::string text =
      read_referenced_file(table, "trajectory", path_beside(*name, scene_file), file_allowed);
  Trajectory trajectory;
  try {
    trajectory = Trajectory(file_poses(text, *name, keys, cutoff));
  } catch (const InputError& error) {
    table.fail("trajectory", error.what());
  } catch (const std::invalid_argument& error) {
    table.fail(cutoff ? "cutoff" : "trajectory", problem_of_pose(error));
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
