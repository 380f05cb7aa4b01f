#pragma once

#include <CLI/CLI.hpp>

namespace dlo::cli {

/// For an option whose value is a share of the rod's length: takes "0.1%" and 0.001, above 0 and
/// below 1.
[[nodiscard]] CLI::Validator share_of_length();

/// For an option that takes "1%" and 0.01 alike, from 0 to `high`.
[[nodiscard]] CLI::Validator share_up_to(double high);

}  // namespace dlo::cli
