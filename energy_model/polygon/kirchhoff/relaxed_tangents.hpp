#pragma once

#include <Eigen/Core>

#include "base/deadline.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {

/// Minimum of the energy of relaxed_polygon.hpp for a round rod, as far as the tangents determine
/// it:
///     sum b / h (1 - t_i.t_(i+1)) - sum h_i n_i.t_i.
struct RelaxedTangents {
  Eigen::Matrix3Xd tangents;  ///< tangents t_i
  Eigen::Matrix3Xd force;     ///< carried force n_i including the contribution of the grips
  double energy = 0;
};

/// Minimises the energy of a polygon by Newton's method on the tangents. The Hessian has blocks of
/// two and is shifted until it is positive definite. An augmented Lagrangian closes the gaps at the
/// grips (GripGap::closed()) as the tangents converge. It needs about 30 steps, whose cost is
/// proportional to the number of intervals. A zero mode, such as the rotation of an arch between
/// clamps in line about that line, may still be moving at the end.
/// @param tangents  initial tangents of the intervals
[[nodiscard]] RelaxedTangents relax_tangents(const RodSpan& span, const RodMesh& mesh,
                                             const Eigen::Matrix3Xd& tangents, Motion motion,
                                             const Deadline& deadline);

}  // namespace dlo::energy_model
