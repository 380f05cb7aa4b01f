#pragma once

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// One reason of a deviation. It is a difference of two shapes, a vector at each arc length.
struct BudgetPart {
  double rms_m = 0;  ///< RMS along the rod [m]
  /// What it contributes to the total, with sign: <part, total> / <total, total>, the product an
  /// integral over the arc length [-]. The shares of all parts and of the remainder add up to 1.
  double share = 0;
};

/// Where a deviation comes from, each part found by switching one thing. With chain(law,
/// bookkeeping, c_c) the polygon at rest, and "rigid" standing for c_c = 100 AE,
///     twist           rod without the twist that the scene holds - rod, where the force model
///                     neglects it, and its chains with it
///     natural curvature
///                     rod without twist that is intrinsically straight - rod without twist, where
///                     the force model neglects the natural curvature, and its chains with it
///     discretisation  chain(hooke, consistent, rigid) - rod without what is neglected
///     bookkeeping     chain(hooke, the scene's, rigid) - chain(hooke, consistent, rigid)
///     law             chain(the scene's, consistent, rigid) - chain(hooke, consistent, rigid)
///     stretch         chain(the scene's, the scene's, c_c), rigid obstacles as under "rigid"
///                     - chain(the scene's, the scene's, rigid)
///     contact         chain(the scene's, the scene's, c_c)
///                     - the same with rigid obstacles as under "rigid"
///     not at rest     force model - force model after Newton's step to rest
///     interaction     what is left of force model - rod
/// A rigid obstacle gives way to a polygon by a stiffness that is c_c's (discretise), so a "rigid"
/// chain is on obstacles of 100 AE, and the part `contact` is what the force model's own cost. That
/// a polygon touches with its points and segments, not with a curve, is discretisation.
/// Law and bookkeeping are switched from the better model, so that neither hides behind the other;
/// what they do together beyond the sum of both is interaction, and so are the second order of
/// "not at rest" and the net torque of the paper's law between unequal segments, which no potential
/// has. All chains start from the force model's shape, so that they are in its state.
struct Budget {
  BudgetPart law;          ///< see above
  BudgetPart bookkeeping;  ///< see above
  BudgetPart twist;        ///< see above; of a scene whose force model has it, zero
  /// See above; of a scene whose force model has it, zero.
  BudgetPart natural_curvature;
  BudgetPart discretisation;  ///< see above
  BudgetPart stretch;         ///< see above
  BudgetPart contact;         ///< see above; zero where no rigid obstacle is touched
  BudgetPart not_at_rest;     ///< see above
  BudgetPart interaction;     ///< see above
  double total_m = 0;         ///< RMS of force model - rod
};

/// @param scene  the scene;  @param force  its force model at rest
/// @param reference  the rod in the same state
/// @throws InputError, ConvergenceError
[[nodiscard]] Budget error_budget(const Scene& scene, const Solution& force,
                                  const Reference& reference, const SolveOptions& options = {});

}  // namespace dlo::compare
