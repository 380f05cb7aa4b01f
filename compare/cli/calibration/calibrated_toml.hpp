#pragma once

#include <string>

#include "dlo/compare/material_fit.hpp"
#include "recording/motion_fit.hpp"

namespace dlo::cli {

/// What was found, for --calibrated; of a rod by E also a materials file with "calibrated".
/// @throws compare::InputError if E is not identified and no shapes were predicted, or the rod is
/// given by EI and a density or the reverse
[[nodiscard]] std::string material_toml(const compare::Calibration& report);

/// Returns stiffness and damping that were found from recordings, with the scene's mass, for
/// --calibrated. @throws compare::ConvergenceError if the stiffness is not identified, InputError
/// as above
[[nodiscard]] std::string motion_toml(const compare::MotionFit& fit, const compare::Scene& scene);

}  // namespace dlo::cli
