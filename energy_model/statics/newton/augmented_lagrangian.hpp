#pragma once

#include "newton/trust_region.hpp"

namespace dlo::energy_model {

/// Descends from solution.x to a point near a minimum of the energy under the constraints c = 0,
/// which need not hold on the way: the method of multipliers, minima of
///     E - mu.c + kappa |c|^2 / 2
/// with mu -> mu - kappa c and a growing kappa, each by Newton's method in a trust region (Moré and
/// Sorensen). Where grips stretch a rod nearly to its length few shapes meet them, all of them
/// close to straight: restoring c = 0 from elsewhere fails there, springs that become stiffer do
/// not.
///
/// Status `converged` says that |c| and the gradient are small enough for Newton's method on both.
void descend_by_augmented_lagrangian(SpanSolution& solution, const TrustRegionOptions& options);

}  // namespace dlo::energy_model
