#pragma once

#include <Eigen/Core>

#include "base/deadline.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {

/// What relaxed_polygon.hpp minimises, of a round rod, as far as its tangents tell it:
///     sum b / h (1 - t_i.t_(i+1)) - sum h_i n_i.t_i.
struct RelaxedTangents {
  Eigen::Matrix3Xd tangents;  ///< t_i
  Eigen::Matrix3Xd force;     ///< n_i with the grips' part
  double energy = 0;
};

/// Every tangent in turn is laid along the sum of what pulls it (neighbours, forces), which is its
/// own minimum, over and over; an augmented Lagrangian closes the gaps at the grips. Of first
/// order, but a sweep over the rod costs so little that it takes a hundredth of the time that
/// L-BFGS takes for the frames.
/// @param tangents of the intervals, where it starts
[[nodiscard]] RelaxedTangents relax_tangents(const RodSpan& span, const RodMesh& mesh,
                                             const Eigen::Matrix3Xd& tangents, Motion motion,
                                             const Deadline& deadline);

}  // namespace dlo::energy_model
