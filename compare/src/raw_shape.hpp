#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dlo::compare {

/// A shape file's numbers, read but not judged.
struct RawShape {
  std::vector<std::array<double, 3>> points;
  std::vector<double> arc_length;  ///< one per point, or none
  std::vector<long> lines;         ///< of the points in the file; none where a format has no lines
  bool in_metres = false;          ///< the file itself says so
};

[[nodiscard]] RawShape read_csv_shape(std::string_view text, const std::string& file);
[[nodiscard]] RawShape read_json_shape(std::string_view text, const std::string& file, double unit);
[[nodiscard]] RawShape read_vtk_shape(std::string_view text, const std::string& file);

/// The whole of a field as a number, which may be infinite or NaN; nothing if it is none.
[[nodiscard]] std::optional<double> shape_number(std::string_view field);

/// A piece of a file for a message: short, in quotes, printable.
[[nodiscard]] std::string quoted_piece(std::string_view piece);

/// @throws InputError if `count` is above most_shape_points. @param where  "file" or "file:line"
void require_point_count(std::size_t count, const std::string& where);

}  // namespace dlo::compare
