#pragma once

#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/energy.hpp"

namespace dlo::compare {

/// The continuous reference of a scene: `energy` or `exact`.
/// @throws InputError, ConvergenceError; that too where a shape is not verified or next to
/// a fold, unless `accept_unverified` is set
[[nodiscard]] energy_model::Equilibrium solve_reference(const Scene& scene, Model model,
                                                        const SolveOptions& options = {});

/// Every equilibrium that the energy model finds, as it is, and where it has looked; those that
/// `options` do not accept are left out, `saddle` is accepted. @throws InputError,
/// ConvergenceError
[[nodiscard]] energy_model::EnergySearch search_states(const Scene& scene,
                                                       const SolveOptions& options = {});

/// Every equilibrium that the energy model finds, as it is: stable ones first, by energy; never
/// empty. @throws InputError, ConvergenceError
[[nodiscard]] std::vector<energy_model::Equilibrium> reference_states(
    const Scene& scene, const SolveOptions& options = {});

/// What touches rigid obstacles in such an equilibrium; its `obstacle` is that of the scene's
/// obstacles.
[[nodiscard]] std::vector<energy_model::ContactPart> contacts_of(
    const Scene& scene, const energy_model::Equilibrium& equilibrium);

}  // namespace dlo::compare
