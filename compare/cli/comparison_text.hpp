#pragma once

#include <string>

#include "dlo/compare/comparison.hpp"

namespace dlo::cli {

/// A comparison as a person reads it, with a blank line after it.
[[nodiscard]] std::string comparison_text(const compare::Comparison& comparison);

/// A field of a CSV line, quoted where it has to be.
[[nodiscard]] std::string csv_field(const std::string& text);

}  // namespace dlo::cli
