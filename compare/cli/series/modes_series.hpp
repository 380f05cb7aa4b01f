#pragma once

#include <string>

#include "dlo/compare/scene.hpp"
#include "format/json.hpp"
#include "motion/scene_modes.hpp"

namespace dlo::cli {

/// Modes as a person reads them.
/// @param rate  steps of the force model a second
[[nodiscard]] std::string modes_text(const compare::SceneModes& modes, const compare::Scene& scene,
                                     double rate);

/// @param samples  points of each mode's shape
[[nodiscard]] Json modes_json(const compare::SceneModes& modes, const compare::Scene& scene,
                              double rate, int samples);

[[nodiscard]] std::string modes_csv(const compare::SceneModes& modes);

}  // namespace dlo::cli
