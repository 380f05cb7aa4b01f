#pragma once

#include <string>

#include "dlo/compare/material_fit.hpp"

namespace dlo::cli {

/// What was found, for --calibrated; of a rod by E also a materials file with "calibrated".
/// @throws compare::InputError if E is not identified and no shapes were predicted, or the rod is
/// given by EI and a density or the reverse
[[nodiscard]] std::string material_toml(const compare::Calibration& report);

}  // namespace dlo::cli
