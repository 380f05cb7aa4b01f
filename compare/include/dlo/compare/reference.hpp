#pragma once

#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/energy.hpp"

namespace dlo::compare {

/// Returns the model whose equilibrium is a scene's reference: `exact`, which has stretch, where
/// Scene::stretch is Stretch::counted, else `energy`. It is also the default model of `dlo solve`.
[[nodiscard]] Model reference_model(const Scene& scene);

/// Solves a scene by one of the two continuous models.
/// @param model  `energy` or `exact`
/// @throws InputError, ConvergenceError; that too where a shape is not verified or next to
/// a fold, unless `accept_unverified` is set
[[nodiscard]] energy_model::Equilibrium solve_reference(const Scene& scene, Model model,
                                                        const SolveOptions& options = {});
/// Solves a scene by its reference_model().
/// @throws InputError, ConvergenceError as above
[[nodiscard]] energy_model::Equilibrium solve_reference(const Scene& scene,
                                                        const SolveOptions& options = {});

/// Every equilibrium that the energy model finds, as it is, and where it has looked; those that
/// `options` do not accept are left out, `saddle` is accepted. @throws InputError,
/// ConvergenceError
[[nodiscard]] energy_model::EnergySearch search_states(const Scene& scene,
                                                       const SolveOptions& options = {});

/// Every equilibrium that the scene's reference_model() finds, as it is: stable ones first, by
/// energy; never empty. Of a rod that stretches it is the lowest one alone. @throws InputError,
/// ConvergenceError
[[nodiscard]] std::vector<energy_model::Equilibrium> reference_states(
    const Scene& scene, const SolveOptions& options = {});

/// Finds the equilibrium of the energy model that a local search from a shape's points leads to
/// (energy_model::energy_near), whatever its status.
/// @param shape  in the scene's frame, two points or more
/// @throws InputError
[[nodiscard]] energy_model::Equilibrium reference_near(const Scene& scene, const Shape& shape,
                                                       const SolveOptions& options = {});

/// What touches rigid obstacles in such an equilibrium; its `obstacle` is that of the scene's
/// obstacles.
[[nodiscard]] std::vector<energy_model::ContactPart> contacts_of(
    const Scene& scene, const energy_model::Equilibrium& equilibrium);

}  // namespace dlo::compare
