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

}  // namespace dlo::compare
