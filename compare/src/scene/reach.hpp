#pragma once

#include <cstddef>
#include <vector>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// The grippers by growing arc length.
[[nodiscard]] std::vector<const Gripper*> grippers_along(const Scene& scene);

/// Distance [m] that every point of the rod keeps from each obstacle. With the rod's length and
/// grips no point gets further than an ellipsoid between two neighbouring grips (foci the grips,
/// the rod between them as its long axis), or a ball around the last. Without stretch.
[[nodiscard]] std::vector<double> obstacle_clearances(const Scene& scene);

/// The indices of the obstacles that the rod can touch without stretch, the only ones that the
/// continuous models are given. They do not depend on what the rod is made of.
[[nodiscard]] std::vector<std::size_t> obstacles_in_reach(const Scene& scene);

/// Of a rod that stretches, the only ones that the polygons are given: by at most 2 l sqrt(P / EA),
/// P the sum of all loads, since the stretch energy EA d^2 / (2 l) is no more than what the loads
/// do over a way of 2 l. The smaller of EA and the settings' c_c.
[[nodiscard]] std::vector<std::size_t> obstacles_in_reach(const Scene& scene,
                                                          const ForceModelSettings& settings);

/// The forces of all obstacles, those out of reach zero.
/// @param in_reach  of obstacles_in_reach();  @param forces  of these
[[nodiscard]] std::vector<Eigen::Vector3d> forces_of_all(
    const Scene& scene, const std::vector<std::size_t>& in_reach,
    const std::vector<Eigen::Vector3d>& forces);

/// Whether an obstacle that pushes the rod has friction. @param forces  of all obstacles [N]
[[nodiscard]] bool touches_with_friction(const Scene& scene,
                                         const std::vector<Eigen::Vector3d>& forces);

/// Whether an obstacle with friction is in reach. Where none is, friction changes nothing.
[[nodiscard]] bool friction_in_reach(const Scene& scene);

}  // namespace dlo::compare
