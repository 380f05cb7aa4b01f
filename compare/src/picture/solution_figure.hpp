#pragma once

#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "figure/layout.hpp"

namespace dlo::compare {

/// Solutions of one scene: shapes at equal aspect with grippers, obstacles and contact, beside
/// their curvature. Unstable ones are dashed.
/// @param solutions  one or more, of one model
[[nodiscard]] Picture solution_picture(const Scene& scene, const std::vector<Solution>& solutions);

}  // namespace dlo::compare
