#pragma once

#include <string>

#include "format/json.hpp"
#include "paper/moving_tables.hpp"

namespace dlo::cli {

/// The section on Tables 2 to 4 as a person reads it.
[[nodiscard]] std::string moving_text(const compare::MovingReport& report);

/// Its lines of the CSV output: section, scene, item, quantity, value.
[[nodiscard]] std::string moving_csv(const compare::MovingReport& report);

[[nodiscard]] Json moving_json(const compare::MovingReport& report);

}  // namespace dlo::cli
