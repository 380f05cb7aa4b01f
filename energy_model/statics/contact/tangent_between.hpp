#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>

namespace dlo::energy_model {

/// Returns a polygon's tangent at s: between the middles of two segments the weighted sum of their
/// tangents, normalised.
/// @param middles  arc lengths, ascending;  @param tangents  of the segments, unit, 3 x middles
[[nodiscard]] inline Eigen::Vector3d tangent_between(const Eigen::VectorXd& middles,
                                                     const Eigen::Matrix3Xd& tangents, double s) {
  const Eigen::Index last = middles.size() - 1;
  const double* const after = std::lower_bound(middles.data(), middles.data() + last, s);
  const Eigen::Index i = std::max<Eigen::Index>(1, after - middles.data());
  if (last == 0) return tangents.col(0);
  const double share = std::clamp((s - middles[i - 1]) / (middles[i] - middles[i - 1]), 0.0, 1.0);
  const Eigen::Vector3d t = (1 - share) * tangents.col(i - 1) + share * tangents.col(i);
  return t.norm() > 1e-3 ? t.normalized() : Eigen::Vector3d(tangents.col(i));
}

}  // namespace dlo::energy_model
