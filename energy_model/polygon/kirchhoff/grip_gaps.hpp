#pragma once

#include <Eigen/Core>
#include <vector>

#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {

/// The intervals between two neighbouring grips, whose sum of h_i t_i is the way from one to the
/// other, and an augmented Lagrangian's means to keep it: of energy
///     multiplier . gap + 1/2 penalty |gap|^2,
/// so that the rod between them carries - multiplier - penalty gap.
struct GripGap {
  Eigen::Index first, end;
  Eigen::Vector3d chord;
  double slack;  ///< rod to spare
  double penalty;
  Eigen::Vector3d multiplier = Eigen::Vector3d::Zero();

  /// Whether a gap is closed to 1e-4, or to a hundredth of what there is to spare.
  [[nodiscard]] bool closed(const Eigen::Vector3d& gap) const;
};

[[nodiscard]] std::vector<GripGap> grip_gaps(const RodSpan& span, const RodMesh& mesh);

}  // namespace dlo::energy_model
