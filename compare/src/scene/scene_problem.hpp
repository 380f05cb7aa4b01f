#pragma once

#include <cstddef>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::compare {

/// A distributed load as the energy model has it: its linear pieces.
[[nodiscard]] std::vector<energy_model::LineLoad> line_loads(const DistributedLoad& load);

/// The scene as the energy model sees it, with the obstacles in reach; not checked.
[[nodiscard]] energy_model::Problem scene_problem(const Scene& scene);

/// Torsion constant J of a rectangle [m^4], the GJ of a section over its shear modulus G.
///
/// Prandtl's stress function (phi = 0 on the edge, nabla^2 phi = -2, J = 2 int phi) of a strip of
/// thickness b is b^2/4 - y^2. What a cosine series in y with hyperbolic cosines in x takes off, so
/// that phi vanishes at x = +-a/2 too, leaves of its a b^3 / 3
///
///     J = a b^3 / 3 (1 - 192 b / (pi^5 a) sum tanh(n pi a / (2 b)) / n^5),   n = 1, 3, 5, ..
///
/// for either edge as b (Saint-Venant; Timoshenko and Goodier, Theory of Elasticity, art. 109):
/// J = 0.1406 a^4 of a square, 0.2287 a b^3 of a / b = 2.
/// @param width, thickness  the edges [m], > 0, in any order
[[nodiscard]] double rectangle_torsion_constant(double width, double thickness);

/// Makes the rod `factor` times as long, of the same section, with all on it at the same shares.
void scale_length(Scene& scene, double factor);

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
