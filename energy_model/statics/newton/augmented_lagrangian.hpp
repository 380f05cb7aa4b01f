#pragma once

#include "newton/trust_region.hpp"

namespace dlo::energy_model {

/// Descends from solution.x to a point near a minimum of the energy under the constraints c = 0,
/// which need not hold at intermediate points. The method of multipliers minimises
///     E - mu.c + kappa |c|^2 / 2
/// repeatedly, with mu -> mu - kappa c and a growing kappa, each time by Newton's method in a trust
/// region (Moré and Sorensen). If grips stretch a rod nearly to its length, few shapes satisfy the
/// constraints, all of them close to straight. Restoring c = 0 from another shape fails there;
/// penalty springs that become stiffer do not.
///
/// Status `converged` means that |c| and the gradient are small enough for Newton's method on both.
void descend_by_augmented_lagrangian(SpanSolution& solution, const TrustRegionOptions& options);

}  // namespace dlo::energy_model
