#pragma once

namespace dlo::energy_model {

/// Angle beyond which the moment of a joint is constant [rad]: of a `hooke` joint as in the force
/// model, and of a `binormal` joint.
constexpr double fold_angle = 3.0;

}  // namespace dlo::energy_model
