#pragma once

#include <string>
#include <vector>

#include "dlo/compare/material_fit.hpp"
#include "format/json.hpp"

namespace dlo::cli {

/// A fit of E with what it came from, in the forms that the command writes.
struct MaterialReport {
  compare::MaterialFit fit;
  std::vector<compare::Scene> scenes;
  std::vector<std::string> files;
  bool frame_was_found = false;
};

/// Joints of the chains that come nearest to a rod.
[[nodiscard]] std::string chains_text(const std::vector<compare::ChainSprings>& chains);
[[nodiscard]] Json chains_json(const std::vector<compare::ChainSprings>& chains);

[[nodiscard]] std::string material_text(const MaterialReport& report);
[[nodiscard]] std::string material_csv(const MaterialReport& report);
[[nodiscard]] Json material_json(const MaterialReport& report);
/// A materials file for --materials, with the material "calibrated".
/// @throws compare::InputError if there is no value to write
[[nodiscard]] std::string material_toml(const MaterialReport& report);

}  // namespace dlo::cli
