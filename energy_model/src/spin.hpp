#pragma once

#include <Eigen/Core>

namespace dlo::energy_model {

/// cross_matrix(v) w = v x w
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// What the square of a spin of the director p costs through g . p: sym(g p^T) - (g.p) 1.
inline Eigen::Matrix3d spin_curvature(const Eigen::Vector3d& p, const Eigen::Vector3d& g) {
  Eigen::Matrix3d a = (g * p.transpose() + p * g.transpose()) / 2;
  a.diagonal().array() -= g.dot(p);
  return a;
}

}  // namespace dlo::energy_model
