#pragma once

#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::compare {

/// The scene as the energy model sees it, with the obstacles in reach; not checked.
[[nodiscard]] energy_model::Problem scene_problem(const Scene& scene);

}  // namespace dlo::compare
