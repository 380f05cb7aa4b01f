#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Drag on a polygon's points, as it lies [N], 3 x points: that of each segment by halves on its
/// ends, of what of it is on the rod.
/// @param scene       has drag
/// @param arc_length  of the points [m]
[[nodiscard]] Eigen::Matrix3Xd drag_forces(const Scene& scene,
                                           const std::vector<double>& arc_length,
                                           const Eigen::Matrix3Xd& points);

}  // namespace dlo::compare
