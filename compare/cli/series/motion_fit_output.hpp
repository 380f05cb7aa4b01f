#pragma once

#include <string>

#include "format/json.hpp"
#include "recording/motion_fit.hpp"

namespace dlo::cli {

[[nodiscard]] std::string motion_fit_text(const compare::MotionFit& fit,
                                          const compare::Scene& scene);
[[nodiscard]] Json motion_fit_json(const compare::MotionFit& fit, const compare::Scene& scene);

}  // namespace dlo::cli
