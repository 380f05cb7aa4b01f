#pragma once

namespace dlo::energy_model {

/// Beyond this angle the moment of a `hooke` joint stays constant, as the force model's does [rad].
constexpr double fold_angle = 3.0;

}  // namespace dlo::energy_model
