#pragma once

#include <Eigen/Core>

#include "base/deadline.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {

/// What relaxed_polygon.hpp minimises, of a round rod, as far as its tangents tell it:
///     sum b / h (1 - t_i.t_(i+1)) - sum h_i n_i.t_i.
struct RelaxedTangents {
  Eigen::Matrix3Xd tangents;  ///< t_i
  Eigen::Matrix3Xd force;     ///< n_i with the grips' part
  double energy = 0;
};

/// Newton's method on the tangents: steps downhill by a Hessian of blocks of two, shifted until it
/// is positive definite; an augmented Lagrangian closes the gaps at the grips (GripGap::closed())
/// as the tangents come to rest. It takes some 30 steps, each proportional to the intervals. A mode
/// without stiffness, as an arch between clamps in line that rotates around that line, may still
/// move.
/// @param tangents of the intervals, where it starts
[[nodiscard]] RelaxedTangents relax_tangents(const RodSpan& span, const RodMesh& mesh,
                                             const Eigen::Matrix3Xd& tangents, Motion motion,
                                             const Deadline& deadline);

}  // namespace dlo::energy_model
