#pragma once

#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/energy.hpp"

namespace dlo::compare {

/// Returns the model whose equilibrium is a scene's reference: `exact`, which has stretch, where
/// Scene::stretch is Stretch::counted, else `energy`. It is also the default model of `dlo solve`.
[[nodiscard]] Model reference_model(const Scene& scene);

/// Solves a scene by one of the two continuous models. With `exact` and Stretch::automatic the
/// estimate of stretch decides whether the rod stretches.
/// @param model  `energy` or `exact`
/// @throws InputError; ConvergenceError, also if the shape is not verified or near a fold, unless
/// `accept_unverified` is set. A balance under loads without a potential is returned as
/// `not_verified`.
[[nodiscard]] energy_model::Equilibrium solve_reference(const Scene& scene, Model model,
                                                        const SolveOptions& options = {});
/// Solves a scene by its reference_model().
/// @throws InputError, ConvergenceError as solve_reference() with a model
[[nodiscard]] energy_model::Equilibrium solve_reference(const Scene& scene,
                                                        const SolveOptions& options = {});

/// Finds all equilibria of the energy model that a search can find, saddles included, and lists the
/// searches. Shapes that are not verified or near singular are removed unless `accept_unverified`
/// is set.
/// @throws InputError, ConvergenceError
[[nodiscard]] energy_model::EnergySearch search_states(const Scene& scene,
                                                       const SolveOptions& options = {});

/// Finds all equilibria of the scene's reference_model() that a search can find, as
/// search_states(): stable ones first, by energy; never empty. For a rod that stretches only one is
/// found, by solve_reference().
/// @throws InputError, ConvergenceError
[[nodiscard]] std::vector<energy_model::Equilibrium> reference_states(
    const Scene& scene, const SolveOptions& options = {});

/// Finds the equilibrium of the energy model to which a local search from a shape's points
/// converges (energy_model::energy_near), whatever its status.
/// @param shape  in the scene's frame, two points or more
/// @throws InputError
[[nodiscard]] energy_model::Equilibrium reference_near(const Scene& scene, const Shape& shape,
                                                       const SolveOptions& options = {});

/// Returns the contacts with rigid obstacles in an equilibrium; `obstacle` is the index in the
/// scene.
[[nodiscard]] std::vector<energy_model::ContactPart> contacts_of(
    const Scene& scene, const energy_model::Equilibrium& equilibrium);

}  // namespace dlo::compare
