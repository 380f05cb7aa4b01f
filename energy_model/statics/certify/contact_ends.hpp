#pragma once

#include <vector>

#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Where a shape begins and ends to press into an obstacle that yields, and where it passes from
/// one face, edge or corner of it to the next while it does: there the force per length has a kink.
/// By growing s.
[[nodiscard]] std::vector<double> contact_ends(const SpanSolution& solution);

/// Force that the series of a shape may miss because a kink of contact lies within a piece, in the
/// units of the span: next to an end of contact the force per length is at most k times the way to
/// it.
[[nodiscard]] double misplaced_contact(const SpanSolution& solution);

/// How a shape passes the middle of an obstacle that yields.
enum class MiddlePassed {
  none,
  through_line,  ///< the axis of a cylinder or capsule, a ball's centre
  on_ridge,      ///< in a plane to both sides of which a box is left by as near a face
  near,          ///< so near to such a line that the second variation is not seen
};

/// Second variation -(direction . dr(s))^2 of the energy at a point where a shape passes from the
/// part of a box that one face pushes to that of another one: the depth d is the smaller one of
/// d_1 and d_2 there, whose gradients n_1 and n_2 differ, and a displacement dr of the rod shifts
/// the point by ds = -(n_2 - n_1) . dr / ((n_2 - n_1) . t), so that
///     direction = (k d / |(n_2 - n_1) . t|)^(1/2) (n_2 - n_1).
struct RidgeCrossing {
  double s = 0;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
};

/// Returns all of a shape, by growing s.
[[nodiscard]] std::vector<RidgeCrossing> ridge_crossings(const SpanSolution& solution);

/// Beside the axis of a cylinder, r away, the second derivative of a contact's energy is -k R / r
/// across it: what is integrated along a rod that crosses the axis has no lower bound, so that no
/// such equilibrium is stable. Series see it only as far as their nodes are from the axis. On a
/// ridge the force turns round with the side, so that no shape on it is an equilibrium.
[[nodiscard]] MiddlePassed middle_passed(const SpanSolution& solution);

}  // namespace dlo::energy_model
