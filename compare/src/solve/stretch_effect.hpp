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

/// An equilibrium of `energy` or `exact`, and what is known of its rod's stretch.
struct StretchedRod {
  Scene scene;  ///< that was solved: Stretch::none or Stretch::counted
  energy_model::Equilibrium rod;
  StretchEffect effect;  ///< of the shape without stretch; NaN of one that the scene counts
  bool neglects_stretch = false;  ///< though it matters
  StretchDecision decision = StretchDecision::given;
};

/// What is known of a shape that was solved without stretch: it matters where its effect is more
/// than the options' target, or not known and may well be, or, of Stretch::automatic, where grips
/// hold the rod taut, so that EA alone says how it is pulled.
[[nodiscard]] StretchedRod told_of_stretch(const Scene& scene, Model model,
                                           const energy_model::Equilibrium& rod,
                                           const SolveOptions& options);

/// solve_reference() with Stretch::automatic decided: the shape without stretch is solved, and the
/// one with it where that matters and the model has it. The only place that decides.
/// @throws InputError, ConvergenceError as solve_reference()
[[nodiscard]] StretchedRod decide_stretch(const Scene& scene, Model model,
                                          const SolveOptions& options);

}  // namespace dlo::compare
