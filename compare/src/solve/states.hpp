#pragma once

#include <vector>

#include "dlo/compare/compared_state.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// All equilibria of a scene that are found, stable ones first, by energy: those of
/// reference_states, `lowest` even where that wider search does not find it, and of a planar
/// scene's shapes out of its plane also the mirror images.
[[nodiscard]] std::vector<energy_model::Equilibrium> all_states(
    const Scene& scene, const energy_model::Equilibrium& lowest, const SolveOptions& options);

/// What there is to say of the state compared.
/// @param states  of all_states();  @param compared  its index
/// @param from_shape  of each state, RMS distance from the shape that was compared [m]
[[nodiscard]] ComparedState describe_state(const Scene& scene,
                                           const std::vector<energy_model::Equilibrium>& states,
                                           std::size_t compared,
                                           const std::vector<double>& from_shape);

}  // namespace dlo::compare
