#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "base/deadline.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"
#include "kirchhoff/rod_state.hpp"

namespace dlo::energy_model {

/// Coarse equilibrium of a rod whose frames after the first clamp are released. The frames q_i of
/// the intervals h_i of a mesh are at a local minimum of
///     sum 1/2 h (v - u0) . K (v - u0) - sum h_i n_i . t_i,   v = 2 / h vec(q_i* q_(i+1)).
/// h and K are length and stiffness of the rod between the middles of two intervals, or from a
/// middle to a clamp; n_i is the carried force. The sum of h_i t_i between two grips is constrained
/// to their distance vector. For a round rod c = 0, and the first sum is that of (1 - t_i.t_(i+1))
/// b / h: any frames with these tangents are valid.
struct RelaxedPolygon {
  std::vector<Eigen::Quaterniond> frames;  ///< frames of the intervals
  /// Rotations of the frames at clamps that do not hold them, about the clamps' directions [rad].
  std::vector<double> turns;
  Eigen::Matrix3Xd force;  ///< carried force n_i including the contribution of the grips
  double energy = 0;
  Motion motion = Motion::in_space;  ///< motions among which it is a minimum

  [[nodiscard]] Eigen::Matrix3Xd tangents() const;
};

/// Minimises the energy of a polygon from any shape, so that Newton's method starts near a minimum
/// instead of near a saddle. It uses NLopt's L-BFGS on the components of the quaternions; for a
/// round rod it uses Newton's method on the tangents (relaxed_tangents.hpp). An augmented
/// Lagrangian closes the gaps at the grips.
/// @param start  initial frames of the intervals
/// @param motion  in the plane: the start lies in the plane, and so does the result
/// @param deadline  when it has passed, the current shape is returned
[[nodiscard]] RelaxedPolygon relax_polygon(const RodSpan& span, const RodMesh& mesh,
                                           const std::vector<Eigen::Quaterniond>& start,
                                           Motion motion, const Deadline& deadline);

/// Transfers a polygon to another mesh and minimises its energy from there.
[[nodiscard]] RelaxedPolygon relax_on(const RodSpan& span, const RodMesh& finer,
                                      const RodMesh& mesh, const RelaxedPolygon& polygon,
                                      const Deadline& deadline);

/// Local minima that polygon_minima() has found, lowest first.
struct PolygonMinima {
  std::vector<RelaxedPolygon> found;
  bool complete = true;  ///< false if the deadline ended the search early
};

/// Finds local minima of the polygon's energy from all of polygon_starts(), in the span's plane, if
/// it has one, and in space.
[[nodiscard]] PolygonMinima polygon_minima(const RodSpan& span, const RodMesh& mesh,
                                           const Deadline& deadline);

/// Returns the cross-sections at the nodes of a mesh. The frames of a round rod are arbitrary about
/// the tangents (see carry_frames()).
[[nodiscard]] std::vector<RodState> states_of(const RodSpan& span, const RodMesh& mesh,
                                              const RelaxedPolygon& polygon);

}  // namespace dlo::energy_model
