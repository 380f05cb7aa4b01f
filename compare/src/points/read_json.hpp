#pragma once

#include <string>
#include <string_view>

#include "points/raw_shape.hpp"

namespace dlo::compare {

/// Reads a shape as JSON. @param unit  of the points, unless the file itself is in metres [m]
/// @throws InputError naming the file
[[nodiscard]] RawShape read_json_shape(std::string_view text, const std::string& file, double unit);

}  // namespace dlo::compare
