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
  bool in_metres = false;   ///< the file itself states that it is in metres
  std::vector<std::string> notes = {};  ///< how columns of the file were interpreted, for the user
};

/// Checks the number of points.
/// @throws InputError if `count` is above most_shape_points.
/// @param where  "file" or "file:line"
void require_point_count(std::size_t count, const std::string& where);

/// Checks that a shape has no d1, or one per point. @throws InputError if it has not
void require_as_many_d1(const RawShape& raw, const std::string& file);

/// Appends a cell to a polyline.
/// @param cell  indices of its points, two or more
/// @param where  "file" or "file:line"
/// @throws InputError if the cell does not begin where the polyline ends, or has fewer than two
/// points
void join_cell(const std::vector<std::size_t>& cell, std::vector<std::size_t>& order,
               const std::string& where);

/// Returns the points of a shape, with all other data per point, in the given order.
[[nodiscard]] RawShape in_order(const RawShape& points, const std::vector<std::size_t>& order);

/// Name of a shape: FILE, or FILE.npy:INDEX for one frame of an array of frames.
struct ShapeName {
  std::string file;   ///< file to read
  std::string index;  ///< index of the frame; empty: the whole array
};

/// Splits a name into its parts; the name of the file itself may contain colons.
[[nodiscard]] ShapeName shape_name(const std::string& name);

/// Reads a shape as CSV. @throws InputError naming file and line
[[nodiscard]] RawShape read_csv_shape(std::string_view text, const std::string& file);

/// Reads a shape as JSON. @param unit  of the points [m]; must be 1 if the file states metres
/// @throws InputError naming the file
[[nodiscard]] RawShape read_json_shape(std::string_view text, const std::string& file, double unit);

/// Reads a NumPy array: M x 2 or M x 3 of any integer type or of 32 or 64 bit floating-point
/// numbers, in any byte order and memory order. Of an array of frames, frames x M x 2 or frames x
/// M x 3, it reads the frame that the name selects (shape_name).
/// @throws InputError naming the file
[[nodiscard]] RawShape read_npy_shape(std::string_view bytes, const std::string& file);

/// Reads a legacy ASCII VTK polyline. @throws InputError naming file and line
[[nodiscard]] RawShape read_vtk_shape(std::string_view text, const std::string& file);

}  // namespace dlo::compare
