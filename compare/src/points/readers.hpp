#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "decode/npy_array.hpp"

namespace dlo::compare {

/// The numbers of a shape file, read but not checked.
struct RawShape {
  std::vector<std::array<double, 3>> points;
  std::vector<std::array<double, 3>> d1;  ///< one per point, or none
  std::vector<double> arc_length;         ///< one per point, or none
  std::vector<long> lines;  ///< line of each point in the file; empty for formats without lines
  bool in_metres = false;   ///< whether the file itself states that it is in metres
  std::vector<std::string> notes = {};  ///< how columns of the file were interpreted, for the user
};

/// Checks the number of points.
/// @throws InputError if `count` is above most_shape_points.
/// @param where  "file" or "file:line"
void require_point_count(std::size_t count, const std::string& where);

/// Reads a shape as CSV. @throws InputError naming file and line
[[nodiscard]] RawShape read_csv_shape(std::string_view text, const std::string& file);

/// Reads a shape as JSON. @param unit  of the points [m]; must be 1 if the file states metres
/// @throws InputError naming the file
[[nodiscard]] RawShape read_json_shape(std::string_view text, const std::string& file, double unit);

/// Reads a legacy ASCII VTK polyline. @throws InputError naming file and line
[[nodiscard]] RawShape read_vtk_shape(std::string_view text, const std::string& file);

}  // namespace dlo::compare
