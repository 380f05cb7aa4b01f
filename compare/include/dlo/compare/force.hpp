#pragma once

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// The force model at rest. Between several grippers it starts where the chain's lowest shape came
/// from, and from near that shape where it ends in another state, so that both are in the same one;
/// where it still does not, the message says so. Drag grows on the rest without it, frozen on a
/// shape that is sought to be its own rest; nothing is said of stability then.
/// @throws InputError, ConvergenceError as solve_chain
[[nodiscard]] Solution solve_force(const Scene& scene, const ForceModelSettings& settings,
                                   const SolveOptions& options = {});

}  // namespace dlo::compare
