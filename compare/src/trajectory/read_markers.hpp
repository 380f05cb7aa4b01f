#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "dlo/compare/trajectory.hpp"

namespace dlo::compare {

/// A recording as CSV: a header with time, s, x, y, z in any order, then a row for each marker that
/// was seen at a time, in s and m; a marker that was not seen has none. Rows may come in any order.
/// @throws InputError naming the file, the line, and what is allowed
[[nodiscard]] MarkerMotion parse_markers(std::string_view text, const std::string& file);

/// Whether the first row of a CSV text is the header of a recording.
[[nodiscard]] bool has_marker_columns(std::string_view text, const std::string& file);

}  // namespace dlo::compare
