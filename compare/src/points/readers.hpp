#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "decode/npy_array.hpp"

namespace dlo::compare {

/// A shape file's numbers, read but not judged.
struct RawShape {
  std::vector<std::array<double, 3>> points;
  std::vector<std::array<double, 3>> d1;  ///< one per point, or none
  std::vector<double> arc_length;         ///< one per point, or none
  std::vector<long> lines;  ///< of the points in the file; none where a format has no lines
  bool in_metres = false;   ///< the file itself says so
  std::vector<std::string> notes = {};  ///< what was taken for what, for people
};

/// @throws InputError if `count` is above most_shape_points. @param where  "file" or "file:line"
void require_point_count(std::size_t count, const std::string& where);

/// @throws InputError if there are some d1, but not one a point
void require_as_many_d1(const RawShape& raw, const std::string& file);

/// Joins a cell to a polyline. @param cell  indices of its points, two or more
/// @param where  "file" or "file:line" @throws InputError if it does not follow on from it
void join_cell(const std::vector<std::size_t>& cell, std::vector<std::size_t>& order,
               const std::string& where);

/// A shape's points, and all that is known of them, in this order.
[[nodiscard]] RawShape in_order(const RawShape& points, const std::vector<std::size_t>& order);

/// The name of a shape: a file, or FILE.npy:INDEX, one frame of an array of frames.
struct ShapeName {
  std::string file;   ///< to be read
  std::string index;  ///< empty: all of the array
};

/// Returns the parts of a name; a file may have colons in its own.
[[nodiscard]] ShapeName shape_name(const std::string& name);

/// Reads a shape as CSV. @throws InputError naming file and line
[[nodiscard]] RawShape read_csv_shape(std::string_view text, const std::string& file);

/// Reads a shape as JSON. @param unit  of the points, unless the file itself is in metres [m]
/// @throws InputError naming the file
[[nodiscard]] RawShape read_json_shape(std::string_view text, const std::string& file, double unit);

/// Reads a shape as NumPy saves an array: M x 2 or M x 3 of any integers or of 32 or 64 bit
/// floating-point numbers, in any order of bytes and axes; of frames x M x 3 the one that the
/// file's name asks for (shape_name). @throws InputError naming the file
[[nodiscard]] RawShape read_npy_shape(std::string_view bytes, const std::string& file);

/// Reads a legacy ASCII VTK polyline. @throws InputError naming file and line
[[nodiscard]] RawShape read_vtk_shape(std::string_view text, const std::string& file);

}  // namespace dlo::compare
