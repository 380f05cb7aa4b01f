#pragma once

#include <string>

#include "dlo/compare/material_fit.hpp"

namespace dlo::cli {

/// A materials file for --materials, with the material "calibrated".
/// @throws compare::InputError if there is no value to write
[[nodiscard]] std::string material_toml(const compare::Calibration& report);

}  // namespace dlo::cli
