#pragma once

#include <vector>

#include "dlo/compare/solve.hpp"

namespace dlo::compare {

/// All equilibria of a scene that are found, stable ones first, by energy: those of
/// reference_states, `lowest` even where that wider search misses it, and of a planar scene's
/// shapes out of its plane also the mirror images.
[[nodiscard]] std::vector<energy_model::Equilibrium> all_states(
    const Scene& scene, const energy_model::Equilibrium& lowest, const SolveOptions& options);

}  // namespace dlo::compare
