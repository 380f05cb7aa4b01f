#pragma once

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// Finds the polygon of minimal energy. With one clamp at an end, forces in a plane with it and no
/// obstacle in reach its segments are rigid, unless that polygon is unstable. Else they have the
/// force model's c_c, and the lowest of the shapes from all starts is returned.
/// @throws InputError; ConvergenceError, also if a segment differs from its rest length by more
/// than largest_strain(); the message then recommends more points
[[nodiscard]] Solution solve_chain(const Scene& scene, const ForceModelSettings& settings,
                                   const SolveOptions& options = {});

/// Minimises the energy of the polygon with elastic segments downhill from a shape; c_c is that of
/// the settings. For the paper's law between unequal segments see energy_model::PolygonProblem.
/// @param start  any polygon of the scene's rod
/// @throws InputError, also for settings with a joint_law; ConvergenceError
[[nodiscard]] Shape chain_from(const Scene& scene, const ForceModelSettings& settings,
                               const Shape& start, const SolveOptions& options = {});

}  // namespace dlo::compare
