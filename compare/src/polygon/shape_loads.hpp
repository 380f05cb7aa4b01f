#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// Returns the sums of the loads that depend on the shape, drag and forces that follow the rod, on
/// the part of the rod up to each arc length [N]. As in a tension, only the sum at the rod's end
/// excludes forces that act there. Drag is integrated by Gauss's rule between the points at which
/// the derivative of the tangent has kinks.
[[nodiscard]] std::vector<Eigen::Vector3d> shape_loads_before(
    const Scene& scene, const energy_model::Equilibrium& shape,
    const std::vector<double>& arc_lengths);

/// Forces on the points of a polygon [N], 3 x points.
struct PointForces {
  Eigen::Matrix3Xd weights;
  Eigen::Matrix3Xd loads;  ///< all forces of the scene except weight and drag
};

/// Returns the forces on points along a whole rod none of whose loads follows it. Weight and
/// distributed loads act on the point that is nearest along the rod, a load between two points by
/// the lever rule on both. @param s  arc lengths of the points, growing, two or more [m]
[[nodiscard]] PointForces forces_on_points(const Scene& scene, const std::vector<double>& s);

/// Returns the drag on the points of a polygon in its current shape [N], 3 x points. The drag on
/// the part of a segment that belongs to the rod acts by halves on the segment's ends.
/// @param scene       has drag
/// @param arc_length  of the points [m]
[[nodiscard]] Eigen::Matrix3Xd drag_forces(const Scene& scene,
                                           const std::vector<double>& arc_length,
                                           const Eigen::Matrix3Xd& points);

}  // namespace dlo::compare
