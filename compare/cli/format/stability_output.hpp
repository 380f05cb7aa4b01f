#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "format/json.hpp"
#include "study/stability.hpp"
#include "study/stability_map.hpp"

namespace dlo::cli {

/// The hard cases as a person reads them.
/// @param results  of each case those of all steppers, one after the other
/// @param steppers  how many of them
[[nodiscard]] std::string hard_cases_text(const std::vector<compare::StabilityResult>& results,
                                          std::size_t steppers);

[[nodiscard]] Json hard_cases_json(const std::vector<compare::StabilityResult>& results);

[[nodiscard]] std::string hard_cases_csv(const std::vector<compare::StabilityResult>& results);

/// The largest stable c_F, measured and predicted.
[[nodiscard]] std::string stability_map_text(const compare::StabilityMap& map);

[[nodiscard]] Json stability_map_json(const compare::StabilityMap& map);

[[nodiscard]] std::string stability_map_csv(const compare::StabilityMap& map);

}  // namespace dlo::cli
