#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "figure/layout.hpp"
#include "figure/series.hpp"

namespace dlo::compare {

/// Points of all of them, which their picture has to hold.
[[nodiscard]] Eigen::Matrix3Xd points_of(const std::vector<Solution>& solutions);

/// What a picture shows of their shapes, behind first.
[[nodiscard]] std::vector<Series> solution_series(const Scene& scene,
                                                  const std::vector<Solution>& solutions,
                                                  const std::vector<View>& views);

/// Solutions of one scene: shapes at equal aspect with grippers, obstacles and contact, beside
/// their curvature. Unstable ones are dashed.
/// @param solutions  one or more, of one model
[[nodiscard]] Picture solution_picture(const Scene& scene, const std::vector<Solution>& solutions);

}  // namespace dlo::compare
