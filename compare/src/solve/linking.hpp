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

}  // namespace dlo::compare
