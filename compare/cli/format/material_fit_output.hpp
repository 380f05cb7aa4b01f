#pragma once

#include <string>

#include "calibration/calibrated_toml.hpp"  // what is written of a fit too
#include "dlo/compare/material_fit.hpp"
#include "format/json.hpp"

namespace dlo::cli {

[[nodiscard]] std::string material_text(const compare::Calibration& report);
[[nodiscard]] std::string material_csv(const compare::Calibration& report);
[[nodiscard]] Json material_json(const compare::Calibration& report);

}  // namespace dlo::cli
