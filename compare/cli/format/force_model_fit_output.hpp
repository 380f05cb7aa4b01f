#pragma once

#include <string>

#include "dlo/compare/force_model_fit.hpp"
#include "format/json.hpp"

namespace dlo::cli {

[[nodiscard]] std::string force_model_text(const compare::ForceModelFit& fit,
                                           bool target_was_given);
[[nodiscard]] std::string force_model_csv(const compare::ForceModelFit& fit);
[[nodiscard]] Json force_model_json(const compare::ForceModelFit& fit);
/// A parameters file for --parameters and for programs of the user's own.
[[nodiscard]] std::string force_model_toml(const compare::ForceModelFit& fit);

}  // namespace dlo::cli
