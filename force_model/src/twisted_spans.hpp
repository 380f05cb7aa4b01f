#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "dlo/force_model/rod.hpp"

namespace dlo::force_model {

/// Value of 1 + cos(alpha) below which a joint is folded back on itself and has neither a smallest
/// rotation nor a binormal.
inline constexpr double folded_joint_threshold = 1e-12;

/// Returns the next grip along the rod that holds the frame, after `after` or (null) from the
/// beginning; null if there is none.
[[nodiscard]] const Grip* next_framed_grip(const Rod& rod, const Grip* after);

/// Returns the part of the rod between two such grips. @param number  its index in Twist::angles
[[nodiscard]] TwistedSpan make_twisted_span(const Rod& rod, const Grip& first, const Grip& last,
                                            Eigen::Index number);

/// Calls action(span, first grip, last grip) for each span along the rod. Does not allocate.
template <typename Action>
void for_each_twisted_span(const Rod& rod, const Action& action) {
  const Grip* first = next_framed_grip(rod, nullptr);
  if (first == nullptr) return;
  Eigen::Index number = 0;
  for (const Grip* last = next_framed_grip(rod, first); last != nullptr;
       last = next_framed_grip(rod, first)) {
    action(make_twisted_span(rod, *first, *last, number++), *first, *last);
    first = last;
  }
}

/// Returns the largest twist_mode_bound of a rod's spans [N/m]; 0 if there are none.
[[nodiscard]] double fastest_twist_mode(const Rod& rod,
                                        const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// Returns twist_angle of points in any storage.
template <typename Points>
double current_twist_angle(const TwistedSpan& span, const Points& points) {
  const auto segment = [&points](Eigen::Index k) -> Eigen::Vector3d {
    return points.col(k + 1) - points.col(k);
  };
  Eigen::Vector3d t = segment(span.first_segment).normalized();
  Eigen::Vector3d d = span.first_d1 - span.first_d1.dot(t) * t;
  for (Eigen::Index k = span.first_segment + 1; k <= span.last_segment; ++k) {
    const Eigen::Vector3d s = segment(k);
    const double length = s.norm();
    if (!(length > 0)) continue;
    const Eigen::Vector3d next = s / length;
    const double opening = 1 + t.dot(next);
    // Smallest rotation of the component across t.
    if (opening > folded_joint_threshold) d -= d.dot(next) / opening * (t + next);
    t = next;
  }
  const double turned = std::atan2(t.dot(d.cross(span.last_d1)),
                                   d.dot(span.last_d1) - t.dot(d) * t.dot(span.last_d1));
  constexpr double whole = 2 * std::numbers::pi;
  return turned + whole * std::round((span.angle - turned) / whole);
}

}  // namespace dlo::force_model
