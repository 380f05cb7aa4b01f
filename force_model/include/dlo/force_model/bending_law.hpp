#pragma once

namespace dlo::force_model {

/// Dependence of the moment of a joint on its angle alpha (L: mean rest length of the two adjacent
/// segments).
enum class BendingLaw {
  paper,  ///< M = 2 c_b L sin^3(alpha/2): cubic for small angles (paper, Formulas 3 and 4)
  hooke,  ///< M = 2 (EI/L) tan(alpha/2): linear to second order, like that of a rod
};

/// Angle up to which the tangent of the `hooke` law is used [rad]. Beyond it the moment is
/// constant, so that a full fold has a finite moment and a finite potential.
inline constexpr double hooke_fold_angle = 3.0;

}  // namespace dlo::force_model
