#pragma once

#include <string>
#include <string_view>

#include "points/raw_shape.hpp"

namespace dlo::compare {

/// Reads a shape as CSV. @throws InputError naming file and line
[[nodiscard]] RawShape read_csv_shape(std::string_view text, const std::string& file);

}  // namespace dlo::compare
