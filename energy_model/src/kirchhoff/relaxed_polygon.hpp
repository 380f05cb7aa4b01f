#pragma once

#include <vector>

#include "base/deadline.hpp"
#include "kirchhoff/rod_flow.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {

/// A coarse equilibrium: unit tangents t_i of the intervals h_i of a mesh, at a local minimum of
///     sum (1 - t_i.t_(i+1)) / c_(i,i+1) - sum h_i n_i.t_i
/// with c_(i,i+1) the compliance int ds / b between the intervals' middles and n_i the force that
/// they carry, while
/// sum h_i t_i between two grips is the grips' distance.
struct RelaxedPolygon {
  Eigen::Matrix3Xd tangents;  ///< 3 x intervals
  Eigen::Matrix3Xd force;     ///< n_i with the grips' part
  double energy = 0;
};

/// Every tangent in turn is laid along the sum of what pulls it (neighbours, forces), which is its
/// own minimum, over and over; an augmented Lagrangian closes the gaps at the grips. Of first order
/// and slow, but it goes downhill from any shape, so that Newton's method starts near a minimum
/// instead of near a saddle.
/// @param tangents  where it starts
/// @param planar    stay in the span's plane
/// @param deadline  once it has passed, what has been reached is returned as it is
[[nodiscard]] RelaxedPolygon relax_polygon(const RodSpan& span, const RodMesh& mesh,
                                           Eigen::Matrix3Xd tangents, bool planar,
                                           const Deadline& deadline = Deadline());

/// What polygon_minima() has found, lowest first, and whether it came to its end.
struct PolygonMinima {
  std::vector<RelaxedPolygon> found;
  bool complete = true;  ///< false: the deadline has cut the search short
};

/// Local minima of the polygon, lowest first, from these starts: the tangents along the force that
/// is carried, straight along a line, and at an angle a(x) to it, x in [0, 1] along the span,
/// towards each of several normals,
///     a = A cos(pi x) (arch),  A sin(2 pi x) (arch with straight ends),  A cos(2 pi x) (S),
///     2 pi x (loop),
/// where A fits the distance of the outermost grips. The line is theirs, or a clamp's direction. In
/// the plane the normals are its two, in space six around the line.
[[nodiscard]] PolygonMinima polygon_minima(const RodSpan& span, const RodMesh& mesh, bool planar,
                                           const Deadline& deadline = Deadline());

/// Cross-sections at the nodes of a mesh, with any frames (see carry_frames()).
[[nodiscard]] std::vector<RodState> states_of(const RodSpan& span, const RodMesh& mesh,
                                              const RelaxedPolygon& polygon);

}  // namespace dlo::energy_model
