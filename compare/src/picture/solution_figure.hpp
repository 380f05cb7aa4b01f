#pragma once

#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "figure/layout.hpp"
#include "figure/series.hpp"

namespace dlo::compare {

/// What a picture shows of their shapes.
[[nodiscard]] Drawing solution_drawing(const Scene& scene, const std::vector<Solution>& solutions);

/// Solutions of one scene: shapes at equal aspect with grippers, obstacles and contact, beside
/// their curvature. Unstable ones are dashed.
/// @param solutions  one or more, of one model
[[nodiscard]] Picture solution_picture(const Scene& scene, const std::vector<Solution>& solutions);

}  // namespace dlo::compare
