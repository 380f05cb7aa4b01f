#pragma once

#include <string>
#include <vector>

#include "dlo/compare/material_fit.hpp"
#include "format/json.hpp"

namespace dlo::cli {

/// Joints of the chains that come nearest to a rod.
[[nodiscard]] std::string chains_text(const std::vector<compare::ChainSprings>& chains);
[[nodiscard]] Json chains_json(const std::vector<compare::ChainSprings>& chains);

[[nodiscard]] std::string material_text(const compare::Calibration& report);
[[nodiscard]] std::string material_csv(const compare::Calibration& report);
[[nodiscard]] Json material_json(const compare::Calibration& report);
/// A materials file for --materials, with the material "calibrated".
/// @throws compare::InputError if there is no value to write
[[nodiscard]] std::string material_toml(const compare::Calibration& report);

}  // namespace dlo::cli
