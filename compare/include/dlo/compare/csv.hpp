#pragma once

#include <string>

namespace dlo::compare {

/// A field of a CSV line, quoted where it has to be.
[[nodiscard]] std::string csv_field(const std::string& text);

/// A number as every CSV that dlo writes has it, never -0; nothing for NaN and infinity.
/// @param digits  significant ones, 1 to 17
[[nodiscard]] std::string csv_number(double value, int digits = 10);

}  // namespace dlo::compare
