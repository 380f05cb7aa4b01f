#include "kirchhoff/grip_gaps.hpp"

#include <algorithm>

namespace dlo::energy_model {

bool GripGap::closed(const Eigen::Vector3d& gap) const {
  return gap.norm() < std::min(1e-4, slack / 100);
}

std::vector<GripGap> grip_gaps(const RodSpan& span, const RodMesh& mesh) {
  std::vector<GripGap> gaps;
  for (std::size_t k = 1; k < span.holds.size(); ++k) {
    const RodSpan::Hold& from = span.holds[k - 1];
    const RodSpan::Hold& to = span.holds[k];
    const double length = to.at - from.at;
    const Eigen::Vector3d chord = to.position - from.position;
    const double penalty =
        (100 * least_bending_stiffness(span) / (length * length) + 4 * total_load(span)) / length;
    gaps.push_back(
        {node_at(mesh.s, from.at), node_at(mesh.s, to.at), chord, length - chord.norm(), penalty});
  }
  return gaps;
}

}  // namespace dlo::energy_model
