#pragma once

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// Steps the force model to rest. Between several grippers it starts where the search for the
/// chain's lowest shape started, or near that shape if clamps twist the rod. If it converges to
/// another equilibrium, it starts again near the chain's shape, so that both are on the same
/// branch; if it still differs, the message states it, except under drag. Drag is increased from
/// zero, from the equilibrium without drag; the drag is that of a fixed shape, which is iterated
/// until it equals the resulting shape at rest. Stability is then not tested.
/// @throws InputError, ConvergenceError as solve_chain
[[nodiscard]] Solution solve_force(const Scene& scene, const ForceModelSettings& settings,
                                   const SolveOptions& options = {});

}  // namespace dlo::compare
