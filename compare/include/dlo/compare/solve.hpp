#pragma once

#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// Solves a scene. Obstacles out of its rod's reach (see make_plan) are given to no solver; their
/// forces are zero. Continuous models are sampled at `arc_lengths` (or at 101 equal ones if empty);
/// polygons keep their points, or are resampled on straight lines when `arc_lengths` are given.
/// @throws InputError if the model does not know such a scene, ConvergenceError
[[nodiscard]] Solution solve(const Scene& scene, Model model, const SolveOptions& options = {},
                             const std::vector<double>& arc_lengths = {});

/// Every equilibrium that the energy model finds, stable ones first, by energy; an unstable one has
/// a negative smallest_curvature. @throws InputError, ConvergenceError
[[nodiscard]] std::vector<Solution> solve_all(const Scene& scene, const SolveOptions& options = {},
                                              const std::vector<double>& arc_lengths = {});

}  // namespace dlo::compare
