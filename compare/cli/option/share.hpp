#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace dlo::cli {

/// For an option whose value is a share of the rod's length: takes "0.1%" and 0.001, above 0 and
/// below 1.
[[nodiscard]] CLI::Validator share_of_length();

/// For an option that takes "1%" and 0.01 alike, from 0 to `high`.
[[nodiscard]] CLI::Validator share_up_to(double high);

/// "1%" or 0.01 of the rod's length, or a length with a unit, in m. @param name  for messages
/// @throws compare::InputError if it is neither
[[nodiscard]] double tolerance_m(const std::string& name, const std::string& text, double length);

}  // namespace dlo::cli
