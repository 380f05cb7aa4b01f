#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "base/spin.hpp"
#include "polygon/polygon_energy.hpp"

namespace dlo::energy_model {
namespace {

Eigen::Vector3d unit_segment(const Points& points, Eigen::Index k) {
  return (points.col(k + 1) - points.col(k)).normalized();
}

/// A joint with the vector q = tan(alpha/2) b, b the joint's binormal. A displacement of either
/// direction along q rotates the transported frame behind the joint.
struct TurningCorner : SegmentPair {
  double sum;  // 1 + u.v
  Eigen::Vector3d q;

  TurningCorner(const Points& points, Eigen::Index i) : SegmentPair(points, i), sum(1 + u.dot(v)) {
    // A joint folded back on itself has no binormal.
    q = sum > 1e-12 ? Eigen::Vector3d(u.cross(v) / sum) : Eigen::Vector3d::Zero();
  }
};

template <typename Action>
void for_each_corner(const PolygonTwist& twist, const Points& points, const Action& action) {
  for (Eigen::Index i = twist.first_segment + 1; i <= twist.last_segment; ++i) {
    action(i, TurningCorner(points, i));
  }
}

/// Adds the gradient of the twist angle times a factor. A unit tangent that moves by dt sweeps an
/// area q.dt on the sphere with the arcs to its neighbours, and a frame transported along those
/// arcs rotates back by that angle (Gauss and Bonnet).
void add_angle_gradient(const PolygonTwist& twist, double factor, const Points& points,
                        Eigen::Ref<Eigen::Matrix3Xd> gradient) {
  for_each_corner(twist, points, [&](Eigen::Index i, const TurningCorner& corner) {
    const Eigen::Vector3d by_a = factor / corner.a * corner.q;
    const Eigen::Vector3d by_b = factor / corner.b * corner.q;
    gradient.col(i - 1) -= by_a;
    gradient.col(i) += by_a - by_b;
    gradient.col(i + 1) += by_b;
  });
}

}  // namespace

double polygon_twist_angle(const PolygonTwist& twist, const Points& points) {
  Eigen::Quaterniond transport = Eigen::Quaterniond::Identity();
  Eigen::Vector3d t = unit_segment(points, twist.first_segment);
  const Eigen::Vector3d first = twist.first_d1 - twist.first_d1.dot(t) * t;
  for (Eigen::Index k = twist.first_segment + 1; k <= twist.last_segment; ++k) {
    const Eigen::Vector3d next = unit_segment(points, k);
    transport = Eigen::Quaterniond::FromTwoVectors(t, next) * transport;
    t = next;
  }
  const Eigen::Vector3d d = transport.normalized() * first;
  const double angle = std::atan2(t.cross(d).dot(twist.last_d1), d.dot(twist.last_d1));
  return angle + 2 * std::numbers::pi * std::round((twist.angle - angle) / (2 * std::numbers::pi));
}

double add_twist_energy(const PolygonProblem& problem, const Points& points,
                        Eigen::Ref<Eigen::Matrix3Xd> gradient) {
  double energy = 0;
  for (const PolygonTwist& twist : problem.twists) {
    const double angle = polygon_twist_angle(twist, points);
    energy += angle * angle / (2 * twist.compliance);
    add_angle_gradient(twist, angle / twist.compliance, points, gradient);
  }
  return energy;
}

void add_twist_hessian(const PolygonProblem& problem, const Points& points, const AddBlock& add) {
  for (const PolygonTwist& twist : problem.twists) {
    const double moment = polygon_twist_angle(twist, points) / twist.compliance;
    for_each_corner(twist, points, [&](Eigen::Index i, const TurningCorner& corner) {
      const auto& [u, v, a, b] = static_cast<const SegmentPair&>(corner);
      const Eigen::Vector3d& q = corner.q;
      // Derivatives of q / a and q / b by the segments. The skew part of the diagonal blocks
      // cancels between the corners of a segment, because the angle is a function of the points.
      const Eigen::Vector3d t = (u + v) / corner.sum;
      const Eigen::Matrix3d aa = -moment / (2 * a * a) * q * (t + u).transpose();
      const Eigen::Matrix3d bb = -moment / (2 * b * b) * q * (t + v).transpose();
      const Eigen::Matrix3d ab =
          moment / (a * b) * (cross_matrix(u) / corner.sum - q * t.transpose());
      add_difference_block(i - 1, i - 1, aa + aa.transpose(), add);
      add_difference_block(i, i, bb + bb.transpose(), add);
      add_difference_block(i - 1, i, ab, add);
      add_difference_block(i, i - 1, ab.transpose(), add);
    });
  }
}

Eigen::MatrixXd twist_columns(const PolygonProblem& problem, const Points& points) {
  const auto count = static_cast<Eigen::Index>(problem.twists.size());
  Eigen::MatrixXd columns(points.size(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const PolygonTwist& twist = problem.twists[static_cast<std::size_t>(k)];
    Eigen::Matrix3Xd gradient = Eigen::Matrix3Xd::Zero(3, points.cols());
    add_angle_gradient(twist, 1 / std::sqrt(twist.compliance), points, gradient);
    columns.col(k) = gradient.reshaped();
  }
  return columns;
}

}  // namespace dlo::energy_model
