#pragma once

namespace dlo::energy_model {

/// Angle beyond which the moment of a `hooke` or `binormal` joint is constant, as in the force
/// model [rad].
constexpr double fold_angle = 3.0;

}  // namespace dlo::energy_model
