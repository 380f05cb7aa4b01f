#pragma once

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

}  // namespace dlo::compare
