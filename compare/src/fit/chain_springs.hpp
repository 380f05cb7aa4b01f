#pragma once

#include <vector>

#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Springs of chains of equal segments that come nearest to a scene's rod, for each way to hold
/// them that is one of this scene.
/// @param segments  4 to 200
/// @throws ConvergenceError if the rod has no shape
[[nodiscard]] std::vector<ChainSprings> chain_springs(const Scene& scene, int segments,
                                                      const SolveOptions& options);

}  // namespace dlo::compare
