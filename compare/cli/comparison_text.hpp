#pragma once

#include <string>

#include "dlo/compare/comparison.hpp"
#include "dlo/compare/csv.hpp"

namespace dlo::cli {

/// A comparison as a person reads it, with a blank line after it.
[[nodiscard]] std::string comparison_text(const compare::Comparison& comparison);

using compare::csv_field;

}  // namespace dlo::cli
