#pragma once

#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// Of each part that is held at both ends by frames. The twist and the writhe add up to the turns
/// between the frames (Calugareanu, White, Fuller), which no movement changes unless the rod
/// passes through itself; that takes or gives two.
[[nodiscard]] std::vector<Linking> linking_of(const Scene& scene,
                                              const energy_model::Equilibrium& equilibrium);

/// What is wrong with the turns of a shape, for a message; empty: nothing, or it cannot be told.
[[nodiscard]] std::string lost_turns(const std::vector<Linking>& parts);

/// The same of turns that are lost between two shapes of a motion. Where a clamp's direction passes
/// the opposite of another's, held turns, which refer to the shortest rotation between the two, and
/// the writhe change by one turn against each other. That is none that is lost.
[[nodiscard]] std::string lost_turns(const Scene& before, const std::vector<Linking>& parts_before,
                                     const Scene& after, const std::vector<Linking>& parts_after);

}  // namespace dlo::compare
