#pragma once

#include <Eigen/Core>
#include <vector>

#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {

/// Constraint of an augmented Lagrangian that the sum of h_i t_i over the intervals between two
/// neighbouring grips is the vector from one to the other. Its energy is
///     multiplier . gap + 1/2 penalty |gap|^2,
/// so that the rod between the grips carries the force - multiplier - penalty gap.
struct GripGap {
  Eigen::Index first, end;
  Eigen::Vector3d chord;
  double slack;  ///< length of the rod minus the distance of the grips
  double penalty;
  Eigen::Vector3d multiplier = Eigen::Vector3d::Zero();

  /// Whether a gap is smaller than 1e-4 and than a hundredth of the slack.
  [[nodiscard]] bool closed(const Eigen::Vector3d& gap) const;
};

[[nodiscard]] std::vector<GripGap> grip_gaps(const RodSpan& span, const RodMesh& mesh);

}  // namespace dlo::energy_model
