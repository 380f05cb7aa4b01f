#pragma once

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// One cause of a deviation: a difference of two shapes, a vector at each arc length.
struct BudgetPart {
  double rms_m = 0;  ///< RMS along the rod [m]
  /// Signed contribution to the total: <part, total> / <total, total>, the product an integral over
  /// the arc length [-]. The shares of all parts and of the remainder add up to 1; 0 if total is 0.
  double share = 0;
};

/// Causes of the deviation between force model and rod, each isolated by changing one thing. "rod"
/// is the shape of the reference_model(), chain(law, bookkeeping, c_c) the polygon at rest, and
/// "rigid" means c_c = 100 AE, or c_c = AE if the reference stretches:
///     twist           rod without the twist that the scene holds - rod, if the force model and
///                     its chains neglect twist
///     natural curvature
///                     rod without twist that is intrinsically straight - rod without twist, if the
///                     force model and its chains neglect the natural curvature
///     discretisation  chain(hooke, consistent, rigid) - rod without the neglected effects
///     bookkeeping     chain(hooke, the scene's, rigid) - chain(hooke, consistent, rigid)
///     law             chain(the scene's, consistent, rigid) - chain(hooke, consistent, rigid)
///     stretch         chain(the scene's, the scene's, c_c), rigid obstacles as under "rigid"
///                     - chain(the scene's, the scene's, rigid)
///     contact         chain(the scene's, the scene's, c_c)
///                     - the same with rigid obstacles as under "rigid"
///     not at rest     force model - force model after Newton's step to rest
///     interaction     remainder of force model - rod
/// A polygon penetrates a rigid obstacle, whose stiffness is derived from c_c (discretise). A
/// "rigid" chain therefore touches obstacles whose stiffness follows from its own c_c, and the part
/// `contact` is the effect of the force model's own obstacle stiffness. Contact at points and
/// segments instead of along a curve is part of discretisation. Law and bookkeeping are each
/// changed from the better model, so that neither hides behind the other. Their joint effect beyond
/// the sum of both belongs to interaction, and so do the second order of "not at rest" and the net
/// torque of the paper's law between unequal segments, which has no potential. All chains start
/// from the force model's shape, so that they are on its branch of equilibria.
struct Budget {
  BudgetPart law;          ///< joint law of the scene instead of `hooke`
  BudgetPart bookkeeping;  ///< end and mass convention of the scene instead of `consistent`
  BudgetPart twist;        ///< neglected twist; zero if the force model includes twist
  /// Neglected natural curvature; zero if the force model includes it.
  BudgetPart natural_curvature;
  BudgetPart discretisation;  ///< rigid segments instead of a curve
  BudgetPart stretch;         ///< stretch of the segments with the force model's c_c
  /// Effect of the stiffness that the force model gives to rigid obstacles; zero if none is in
  /// reach.
  BudgetPart contact;
  BudgetPart not_at_rest;  ///< distance of the force model from its equilibrium
  BudgetPart interaction;  ///< remainder of the deviation
  double total_m = 0;      ///< RMS of force model - rod
};

/// Splits the deviation of a force model's shape from the rod into its causes.
/// @param scene  the scene;  @param force  its force model at rest
/// @param reference  the rod in the same equilibrium
/// @throws InputError, ConvergenceError
[[nodiscard]] Budget error_budget(const Scene& scene, const Solution& force,
                                  const Reference& reference, const SolveOptions& options = {});

}  // namespace dlo::compare
