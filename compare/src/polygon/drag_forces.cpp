#include "polygon/drag_forces.hpp"

#include <algorithm>

namespace dlo::compare {

Eigen::Matrix3Xd drag_forces(const Scene& scene, const std::vector<double>& arc_length,
                             const Eigen::Matrix3Xd& points) {
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, points.cols());
  for (Eigen::Index i = 0; i + 1 < points.cols(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double from = std::max(arc_length[at], 0.0);
    const double to = std::min(arc_length[at + 1], scene.length);
    if (!(to > from)) continue;
    const Eigen::Vector3d tangent = (points.col(i + 1) - points.col(i)).normalized();
    const Eigen::Vector3d half = (to - from) / 2 * scene.drag->force(tangent);
    forces.col(i) += half;
    forces.col(i + 1) += half;
  }
  return forces;
}

}  // namespace dlo::compare
