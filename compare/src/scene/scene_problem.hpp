#pragma once

#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::compare {

/// A distributed load as the energy model has it: its linear pieces.
[[nodiscard]] std::vector<energy_model::LineLoad> line_loads(const DistributedLoad& load);

/// The scene as the energy model sees it, with the obstacles in reach; not checked.
[[nodiscard]] energy_model::Problem scene_problem(const Scene& scene);

}  // namespace dlo::compare
