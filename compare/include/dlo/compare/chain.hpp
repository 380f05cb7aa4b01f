#pragma once

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// The polygon of minimal energy: one clamp at an end, forces in a plane and no obstacle, of rigid
/// segments; else of segments with the force model's c_c, of several starts' shapes the lowest.
/// @throws InputError, ConvergenceError; that too where a segment differs from its rest length by
/// more than largest_strain(), with the number of points that would do
[[nodiscard]] Solution solve_chain(const Scene& scene, const ForceModelSettings& settings,
                                   const SolveOptions& options = {});

/// The chain of elastic segments in the equilibrium downhill of a shape; its c_c is the
/// settings'. For the paper's law between unequal segments see energy_model::PolygonProblem.
/// @param start  any polygon of the scene's rod
/// @throws InputError, ConvergenceError
[[nodiscard]] Shape chain_from(const Scene& scene, const ForceModelSettings& settings,
                               const Shape& start, const SolveOptions& options = {});

}  // namespace dlo::compare
