#pragma once

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// An equilibrium of `energy` or `exact`, and the effect of stretch on it.
struct StretchedRod {
  Scene scene;  ///< scene that was solved: Stretch::none or Stretch::counted
  energy_model::Equilibrium rod;
  StretchEffect effect;  ///< effect on the shape without stretch; NaN if that was not solved
  bool neglects_stretch = false;  ///< whether stretch is not modelled although it matters
  StretchDecision decision = StretchDecision::given;
};

/// Returns a shape that was solved without stretch together with the effect of stretch. Stretch
/// matters if its effect exceeds the options' target, or is unknown and may exceed it, or if the
/// scene has Stretch::automatic and grips hold the rod taut, so that its tension depends on EA
/// alone.
[[nodiscard]] StretchedRod with_stretch_effect(const Scene& scene, Model model,
                                               const energy_model::Equilibrium& rod,
                                               const SolveOptions& options);

/// Solves a scene as solve_reference(), and decides Stretch::automatic: the shape without stretch
/// is solved, and the shape with stretch if stretch matters and the model has it. If grips hold the
/// rod taut and the model has stretch, only the latter is solved. No other function makes this
/// decision.
/// @throws InputError, ConvergenceError in the cases of solve_reference()
[[nodiscard]] StretchedRod decide_stretch(const Scene& scene, Model model,
                                          const SolveOptions& options);

}  // namespace dlo::compare
