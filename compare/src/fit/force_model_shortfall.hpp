#pragma once

#include <string>
#include <vector>

#include "dlo/compare/force_model_fit.hpp"

namespace dlo::compare {

/// Returns the reasons in ForceModelFit::shortfall_reasons.
[[nodiscard]] std::vector<std::string> target_shortfall_reasons(const ForceModelFit& fit);

}  // namespace dlo::compare
