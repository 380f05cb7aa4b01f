#pragma once

namespace dlo::force_model {

/// How the moment of a joint grows with its turning angle alpha (L: mean rest length of the two
/// segments that meet there).
enum class BendingLaw {
  paper,  ///< M = 2 c_b L sin^3(alpha/2): cubic for small angles (paper, Formulas 3 and 4)
  hooke,  ///< M = 2 (EI/L) tan(alpha/2): linear to second order, as a rod's
};

/// The `hooke` law's tangent is followed up to this angle [rad]; beyond it the moment stays
/// constant, so that a full fold has a finite moment and a finite potential.
inline constexpr double hooke_fold_angle = 3.0;

}  // namespace dlo::force_model
