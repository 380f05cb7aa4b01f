#pragma once

#include <string>
#include <vector>

#include "dlo/compare/force_model_fit.hpp"

namespace dlo::compare {

/// Returns the reasons in ForceModelFit::why_missed.
[[nodiscard]] std::vector<std::string> shortfall(const ForceModelFit& fit);

}  // namespace dlo::compare
