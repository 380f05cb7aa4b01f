#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// The sum of what depends on a shape, drag and forces that follow the rod, before arc lengths [N]:
/// at the rod's end without what acts there, as a tension counts. Drag by Gauss's rule between
/// where the tangent has kinks in its rate.
[[nodiscard]] std::vector<Eigen::Vector3d> shape_loads_before(
    const Scene& scene, const energy_model::Equilibrium& shape,
    const std::vector<double>& arc_lengths);

/// Drag on a polygon's points, as it lies [N], 3 x points: that of each segment by halves on its
/// ends, of what of it is on the rod.
/// @param scene       has drag
/// @param arc_length  of the points [m]
[[nodiscard]] Eigen::Matrix3Xd drag_forces(const Scene& scene,
                                           const std::vector<double>& arc_length,
                                           const Eigen::Matrix3Xd& points);

}  // namespace dlo::compare
