#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "../helpers.hpp"

namespace dlo::test {

/// Moment of a joint divided by its spring constant, and its derivative by the angle.
struct JointMoment {
  double value, slope;
};

inline JointMoment linear_moment(double angle) { return {angle, 1}; }
inline JointMoment hooke_moment(double angle) {
  return {2 * std::tan(angle / 2), 1 / std::pow(std::cos(angle / 2), 2)};
}
inline JointMoment binormal_moment(double angle) {
  const double t = std::tan(angle / 2);
  return {2 * t * (1 + t * t), (1 + t * t) * (1 + 3 * t * t)};
}

/// Computes the points of a planar chain at rest by Newton's method in the angles of its segments,
/// with growing loads and without code of the library's polygons. The first segment is held along
/// +x.
/// @param segments  lengths [m], n;  @param springs  of the joints [N m], n - 1
/// @param forces  on the points [N], 2 x (n + 1)
template <typename Moment>
Eigen::Matrix3Xd chain_at_rest(const Eigen::VectorXd& segments, const Eigen::VectorXd& springs,
                               const Eigen::Matrix2Xd& forces, const Moment& moment) {
  const Eigen::Index n = segments.size();
  Eigen::Matrix2Xd beyond = forces.rightCols(n);
  for (Eigen::Index i = n - 1; i > 0; --i) beyond.col(i - 1) += beyond.col(i);
  Eigen::VectorXd angles = Eigen::VectorXd::Zero(n);
  constexpr int stages = 40;
  for (int stage = 1; stage <= stages; ++stage) {
    for (int step = 0; step < 60; ++step) {
      Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
      Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(n, n);
      for (Eigen::Index j = 0; j + 1 < n; ++j) {
        const JointMoment m = moment(angles[j + 1] - angles[j]);
        gradient[j] -= springs[j] * m.value;
        gradient[j + 1] += springs[j] * m.value;
        hessian(j, j) += springs[j] * m.slope;
        hessian(j + 1, j + 1) += springs[j] * m.slope;
        hessian(j, j + 1) -= springs[j] * m.slope;
        hessian(j + 1, j) -= springs[j] * m.slope;
      }
      for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::Vector2d f = segments[i] * stage / stages * beyond.col(i);
        const double c = std::cos(angles[i]);
        const double s = std::sin(angles[i]);
        gradient[i] -= -s * f.x() + c * f.y();
        hessian(i, i) += c * f.x() + s * f.y();
      }
      const Eigen::VectorXd way =
          hessian.bottomRightCorner(n - 1, n - 1).ldlt().solve(-gradient.tail(n - 1));
      const double most = way.cwiseAbs().maxCoeff();
      angles.tail(n - 1) += way * std::min(1.0, 0.3 / std::max(most, 1e-300));
      if (most < 1e-14) break;
    }
  }
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, n + 1);
  for (Eigen::Index i = 0; i < n; ++i) {
    points.col(i + 1) =
        points.col(i) + segments[i] * Eigen::Vector3d(std::cos(angles[i]), std::sin(angles[i]), 0);
  }
  return points;
}

}  // namespace dlo::test
