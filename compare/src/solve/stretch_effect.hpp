#pragma once

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// What stretch would change of an equilibrium of `energy` or `exact`, by the polygon that answers
/// for the rod (PolygonResponse); where none does, as of a rod that touches an obstacle, by the
/// energy model of the rod as much longer as it is stretched in the mean. Neither is asked where
/// strain (1 + 1 / slack), of which the answer is a part but next to a bifurcation, stays below the
/// target; nor of a rod whose EA is not known, or that grips hold taut.
[[nodiscard]] StretchEffect stretch_effect(const Scene& scene, Model model,
                                           const energy_model::Equilibrium& rod,
                                           const SolveOptions& options);

/// Whether it is more than the options' target, or not known and may well be.
[[nodiscard]] bool matters(const StretchEffect& effect, const Scene& scene,
                           const SolveOptions& options);

}  // namespace dlo::compare
