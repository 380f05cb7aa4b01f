#include "dlo/force_model/twist.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "dlo/force_model/bending_law.hpp"
#include "require.hpp"
#include "twisted_spans.hpp"

namespace dlo::force_model {
namespace {

using Points = Eigen::Ref<const Eigen::Matrix3Xd>;

void require_segments(const char* function, const TwistedSpan& span, const Points& points) {
  require(span.first_segment >= 0 && span.first_segment < span.last_segment, function,
          "first_segment", static_cast<double>(span.first_segment),
          ">= 0 and less than last_segment");
  require(span.last_segment + 1 < points.cols(), function, "last_segment",
          static_cast<double>(span.last_segment), "a segment of the rod");
  require_positive(function, "compliance", span.compliance);
}

/// Quantities of a joint of a span that (2) contains.
struct TwistedJoint {
  Eigen::Vector3d half_binormal = Eigen::Vector3d::Zero();  // kb / 2
  double a = 1;                                             // lengths of its segments [m]
  double b = 1;
  double tangent = 0;  // tan(alpha/2), followed to hooke_fold_angle
};

TwistedJoint twisted_joint(const Points& points, Eigen::Index i) {
  const Eigen::Vector3d before = points.col(i) - points.col(i - 1);
  const Eigen::Vector3d after = points.col(i + 1) - points.col(i);
  const double a = before.norm();
  const double b = after.norm();
  TwistedJoint joint;
  if (!(a > 0 && b > 0)) return joint;
  joint.a = a;
  joint.b = b;
  const double opening = 1 + before.dot(after) / (a * b);
  static const double most = std::tan(hooke_fold_angle / 2);
  joint.tangent = most;
  if (!(opening > folded_joint_threshold)) return joint;
  joint.half_binormal = before.cross(after) / (a * b * opening);
  joint.tangent = std::min(most, joint.half_binormal.norm());
  return joint;
}

void add_gradient(const TwistedSpan& span, double factor, const Points& points,
                  Eigen::Ref<Eigen::Matrix3Xd> sum) {
  for (Eigen::Index i = span.first_segment + 1; i <= span.last_segment; ++i) {
    const TwistedJoint joint = twisted_joint(points, i);
    const Eigen::Vector3d by_a = factor / joint.a * joint.half_binormal;
    const Eigen::Vector3d by_b = factor / joint.b * joint.half_binormal;
    sum.col(i - 1) -= by_a;
    sum.col(i) += by_a - by_b;
    sum.col(i + 1) += by_b;
  }
}

}  // namespace

double twist_angle(const TwistedSpan& span, const Points& points) {
  require_segments("twist_angle", span, points);
  return current_twist_angle(span, points);
}

double twist_energy(const TwistedSpan& span, const Points& points) {
  require_segments("twist_energy", span, points);
  const double theta = current_twist_angle(span, points);
  return theta * theta / (2 * span.compliance);  // (1)
}

void add_twist_forces(const TwistedSpan& span, const Points& points,
                      Eigen::Ref<Eigen::Matrix3Xd> forces) {
  require_segments("add_twist_forces", span, points);
  require(forces.cols() == points.cols(), "add_twist_forces", "columns of forces",
          static_cast<double>(forces.cols()), "the number of points");
  add_gradient(span, -current_twist_angle(span, points) / span.compliance, points, forces);
}

void twist_gradient(const TwistedSpan& span, const Points& points,
                    Eigen::Ref<Eigen::Matrix3Xd> gradient) {
  require_segments("twist_gradient", span, points);
  require(gradient.cols() == points.cols(), "twist_gradient", "columns of gradient",
          static_cast<double>(gradient.cols()), "the number of points");
  gradient.setZero();
  add_gradient(span, 1, points, gradient);
}

double twist_mode_bound(const TwistedSpan& span,
                        const Eigen::Ref<const Eigen::VectorXd>& rest_lengths,
                        const Points& points) {
  require_segments("twist_mode_bound", span, points);
  require(rest_lengths.size() + 1 == points.cols(), "twist_mode_bound", "size of rest_lengths",
          static_cast<double>(rest_lengths.size()), "one less than points");
  // The gradient at a point is the difference of contributions of its two segments.
  Eigen::Vector3d by_previous = Eigen::Vector3d::Zero();  // segment
  TwistedJoint joint;
  double squared = 0;
  double steepest = 0;
  double shortest = (points.col(span.first_segment + 1) - points.col(span.first_segment)).norm();
  shortest = std::max(shortest, rest_lengths[span.first_segment] / 10);
  for (Eigen::Index i = span.first_segment + 1; i <= span.last_segment; ++i) {
    const Eigen::Vector3d binormal_before = joint.half_binormal;
    joint = twisted_joint(points, i);
    const Eigen::Vector3d by_segment = (binormal_before + joint.half_binormal) / joint.a;
    squared += (by_previous - by_segment).squaredNorm();
    by_previous = by_segment;
    steepest = std::max(steepest, joint.tangent);
    shortest = std::min(shortest, std::max(joint.b, rest_lengths[i] / 10));
  }
  const Eigen::Vector3d by_last = joint.half_binormal / joint.b;
  squared += (by_previous - by_last).squaredNorm() + by_last.squaredNorm();
  const double moment = std::abs(current_twist_angle(span, points)) / span.compliance;
  return squared / span.compliance +
         8 * moment * (1 + steepest + steepest * steepest) / (shortest * shortest);
}

double fastest_twist_mode(const Rod& rod, const Points& points) {
  // A grip that ends two spans holds both of its points, so no free point belongs to two spans.
  double fastest = 0;
  for_each_twisted_span(
      rod, [&](const TwistedSpan& span, const Grip& /*first*/, const Grip& /*last*/) {
        fastest = std::max(fastest, twist_mode_bound(span, rod.rest_lengths, points));
      });
  return fastest;
}

}  // namespace dlo::force_model
