#pragma once

#include <string>

namespace dlo::compare {

/// A field of a CSV line, quoted where it has to be.
[[nodiscard]] std::string csv_field(const std::string& text);

/// A number with 10 significant digits, never -0; nothing for NaN and infinity.
[[nodiscard]] std::string csv_number(double value);

}  // namespace dlo::compare
