#pragma once

#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/vibrations.hpp"

namespace dlo::compare {

/// Returns the masses of a scene's rod, of its sections and of what hangs on it.
[[nodiscard]] energy_model::Inertia scene_inertia(const Scene& scene);

}  // namespace dlo::compare
