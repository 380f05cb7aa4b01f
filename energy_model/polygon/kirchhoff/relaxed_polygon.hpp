#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "base/deadline.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"
#include "kirchhoff/rod_state.hpp"

namespace dlo::energy_model {

/// A coarse equilibrium of a rod whose frames after the first clamp are released: frames q_i of the
/// intervals h_i of a mesh, at a local minimum of
///     sum 1/2 h (v - u0) . K (v - u0) - sum h_i n_i . t_i,   v = 2 / h vec(q_i* q_(i+1)),
/// h and K of the rod between the intervals' middles, or to a clamp, and n_i the force that they
/// carry, while sum h_i t_i between two grips is the grips' distance. Of a round rod c = 0 and the
/// first sum is that of (1 - t_i.t_(i+1)) b / h: the frames are any with these tangents.
struct RelaxedPolygon {
  std::vector<Eigen::Quaterniond> frames;  ///< of the intervals
  std::vector<double> turns;               ///< of the frames at clamps that do not hold them,
                                           ///< about directions
  Eigen::Matrix3Xd force;                  ///< n_i with the grips' part
  double energy = 0;
  Motion motion = Motion::in_space;  ///< in which it is a minimum

  [[nodiscard]] Eigen::Matrix3Xd tangents() const;
};

/// Downhill from any shape, so that Newton's method starts near a minimum instead of near a saddle:
/// NLopt's L-BFGS on the quaternions' components, of a round rod Newton's method on its tangents
/// (relaxed_tangents.hpp), with an augmented Lagrangian that closes the gaps at the grips.
/// @param start frames of the intervals
/// @param motion in the plane: the start lies in it, and so does all that it is relaxed to
/// @param deadline once it has passed, what has been reached is returned as it is
[[nodiscard]] RelaxedPolygon relax_polygon(const RodSpan& span, const RodMesh& mesh,
                                           const std::vector<Eigen::Quaterniond>& start,
                                           Motion motion, const Deadline& deadline);

/// The polygon on another mesh, relaxed from where it is.
[[nodiscard]] RelaxedPolygon relax_on(const RodSpan& span, const RodMesh& finer,
                                      const RodMesh& mesh, const RelaxedPolygon& polygon,
                                      const Deadline& deadline);

/// What polygon_minima() has found, lowest first, and whether it came to its end.
struct PolygonMinima {
  std::vector<RelaxedPolygon> found;
  bool complete = true;  ///< false: the deadline has cut the search short
};

/// Local minima of the polygon from all of polygon_starts(), in the span's plane, if it has one,
/// and in space.
[[nodiscard]] PolygonMinima polygon_minima(const RodSpan& span, const RodMesh& mesh,
                                           const Deadline& deadline);

/// Cross-sections at the nodes of a mesh; those of a round rod have any frames (see
/// carry_frames()).
[[nodiscard]] std::vector<RodState> states_of(const RodSpan& span, const RodMesh& mesh,
                                              const RelaxedPolygon& polygon);

}  // namespace dlo::energy_model
