#pragma once

#include <cstddef>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::compare {

/// Returns the linear parts of a distributed load, as the energy model needs them.
[[nodiscard]] std::vector<energy_model::LineLoad> line_loads(const DistributedLoad& load);

/// Returns the scene as a problem of the energy model, with the obstacles in reach, and with EA
/// only for Stretch::counted; not checked.
[[nodiscard]] energy_model::Problem scene_problem(const Scene& scene);

/// Returns the torsion constant J of a rectangle [m^4], GJ of a section divided by its shear
/// modulus G.
///
/// Prandtl's stress function (phi = 0 on the edge, nabla^2 phi = -2, J = 2 int phi) of a strip of
/// thickness b is b^2/4 - y^2, with J = a b^3 / 3 over the width a. A cosine series in y with
/// hyperbolic cosines in x is subtracted, so that phi vanishes at x = +-a/2 too. The result is
///
///     J = a b^3 / 3 (1 - 192 b / (pi^5 a) sum tanh(n pi a / (2 b)) / n^5),   n = 1, 3, 5, ..
///
/// for either edge as b (Saint-Venant; Timoshenko and Goodier, Theory of Elasticity, art. 109):
/// J = 0.1406 a^4 of a square, 0.2287 a b^3 of a / b = 2.
/// @param width, thickness  the edges [m], > 0, in any order
[[nodiscard]] double rectangle_torsion_constant(double width, double thickness);

/// Makes the rod `factor` times as long, with the same section, and scales the arc lengths of
/// grippers, loads and sections. Natural strains, `rest_shape` and `start` are not scaled.
void scale_length(Scene& scene, double factor);

/// Returns the grippers by increasing arc length.
[[nodiscard]] std::vector<const Gripper*> grippers_by_arc_length(const Scene& scene);

/// Returns, for each obstacle, a lower bound of the distance between it and the points of the rod
/// [m], without stretch; negative: a point might enter it. With the rod's length and grips no point
/// leaves an ellipsoid between two adjacent grips (foci the grips, long axis the rod's length
/// between them), or a ball around the first or last grip.
[[nodiscard]] std::vector<double> obstacle_clearances(const Scene& scene);

/// Returns the indices of the obstacles that the rod can touch without stretch. Only these are
/// given to the continuous models. They do not depend on the rod's stiffness.
[[nodiscard]] std::vector<std::size_t> obstacles_in_reach(const Scene& scene);

/// Returns the indices of the obstacles that a rod that stretches can touch; only these are given
/// to the polygons. It extends by at most 2 l sqrt(P / EA), P the sum of weight and loads, since
/// the stretch energy EA d^2 / (2 l) is at most the work of the loads over a displacement of 2 l.
/// EA is the smaller one of EA and the settings' c_c.
[[nodiscard]] std::vector<std::size_t> obstacles_in_reach(const Scene& scene,
                                                          const ForceModelSettings& settings);

/// Returns the forces of all obstacles; those of obstacles out of reach are zero.
/// @param in_reach  result of obstacles_in_reach();  @param forces  forces of these obstacles
[[nodiscard]] std::vector<Eigen::Vector3d> expand_obstacle_forces(
    const Scene& scene, const std::vector<std::size_t>& in_reach,
    const std::vector<Eigen::Vector3d>& forces);

/// Whether an obstacle that pushes the rod has friction. @param forces  of all obstacles [N]
[[nodiscard]] bool has_friction_contact(const Scene& scene,
                                        const std::vector<Eigen::Vector3d>& forces);

/// Whether an obstacle with friction is in reach; if none is, friction has no effect.
[[nodiscard]] bool is_friction_in_reach(const Scene& scene);

}  // namespace dlo::compare
