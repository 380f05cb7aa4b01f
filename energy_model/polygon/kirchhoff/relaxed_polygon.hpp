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
  /// Rotation of each clamp's frame about its direction, see clamp_frame(); 0 for the first [rad].
  std::vector<double> turns;
  Eigen::Matrix3Xd force;  ///< carried force n_i including the contribution of the grips
  double energy = 0;
  Motion motion = Motion::in_space;  ///< motions among which it is a minimum

  [[nodiscard]] Eigen::Matrix3Xd tangents() const;
};

/// Minimises the energy of a polygon from any shape, so that Newton's method of multiple shooting
/// starts near a minimum instead of near a saddle. It uses Newton's method on the spins of the
/// frames; of a round rod, whose energy does not depend on the roll, on those across the tangents.
/// The Hessian is banded and is shifted until it is positive definite. An augmented Lagrangian
/// closes the gaps at the grips (ChordConstraint::closed()) as the frames converge. It needs about
/// 30 steps, whose cost is proportional to the number of intervals. A zero mode, such as the
/// rotation of an arch between clamps in line about that line, may still be moving at the end.
/// @param start  initial frames of the intervals
/// @param motion  in the plane: the start lies in the plane, and so does the result
/// @param deadline  when it has passed, the current shape is returned
[[nodiscard]] RelaxedPolygon relax_polygon(const RodSpan& span, const RodMesh& mesh,
                                           const std::vector<Eigen::Quaterniond>& start,
                                           Motion motion, const Deadline& deadline);

/// Transfers a polygon to another mesh and minimises its energy from there.
[[nodiscard]] RelaxedPolygon relax_on_mesh(const RodSpan& span, const RodMesh& finer,
                                           const RodMesh& mesh, const RelaxedPolygon& polygon,
                                           const Deadline& deadline);

/// Local minima that polygon_minima() has found, lowest first.
struct PolygonMinima {
  std::vector<RelaxedPolygon> found;
  bool complete = true;  ///< whether the search ended before its deadline
};

/// Finds local minima of the polygon's energy from all of polygon_starts(), in the span's plane, if
/// it has one, and in space.
[[nodiscard]] PolygonMinima polygon_minima(const RodSpan& span, const RodMesh& mesh,
                                           const Deadline& deadline);

/// Returns the cross-sections at the nodes of a mesh. The frames of a round rod are arbitrary about
/// the tangents (see carry_frames()).
[[nodiscard]] std::vector<RodState> states_of(const RodSpan& span, const RodMesh& mesh,
                                              const RelaxedPolygon& polygon);

/// Constraint of an augmented Lagrangian that the sum of h_i t_i over the intervals between two
/// neighbouring grips is the vector from one to the other. Its energy is
///     multiplier . gap + 1/2 penalty |gap|^2,
/// so that the rod between the grips carries -multiplier - penalty gap in addition to
/// internal_force().
struct ChordConstraint {
  Eigen::Index first, end;
  Eigen::Vector3d chord;
  double slack;  ///< length of the rod minus the distance of the grips
  double penalty;
  Eigen::Vector3d multiplier = Eigen::Vector3d::Zero();

  /// Whether a gap is smaller than 1e-4 and than a hundredth of the slack.
  [[nodiscard]] bool closed(const Eigen::Vector3d& gap) const;
};

[[nodiscard]] std::vector<ChordConstraint> grip_gaps(const RodSpan& span, const RodMesh& mesh);

/// Returns initial guesses for relaxing a polygon, as frames of the intervals of a mesh. They are:
/// straight along a line; with tangents along the carried force; and at an angle a(x) to the line,
/// x in [0, 1] along the span, towards each of several normals,
///     a = A cos(pi x) (arch),  A sin(2 pi x) (arch with straight ends),  A cos(2 pi x) (S),
///     2 pi x (loop),
/// where A fits the distance of the outermost grips. The line connects these grips, or has the
/// direction of a clamp. In a plane there are two normals, in space six or four around the line.
/// For a rod that is not round there are two more: its natural shape from its first clamp on, and
/// tangents against the force. A round rod may be in equilibrium in the latter and stay there. In
/// space, the four guesses of such a rod that have no angle a(x) are tilted out of the plane in
/// which they might lie.
[[nodiscard]] std::vector<std::vector<Eigen::Quaterniond>> polygon_starts(const RodSpan& span,
                                                                          const RodMesh& mesh,
                                                                          Motion motion);

}  // namespace dlo::energy_model
