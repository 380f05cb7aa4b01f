#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

namespace dlo::energy_model {

/// An element: a smooth part of a span. Elements end where curvature may have kinks or jumps, at
/// loads, grips, contacts and section changes, and where boundary layers have decayed.
/// On an element the elastic part of a strain is a series in orthonormal Legendre polynomials p_k
/// on [0, 1], scaled so that its energy is half the sum of the squares of the coefficients.
struct Element {
  double begin = 0;
  double length = 0;
  /// EI about d1 and d2, and GJ, divided by the span's reference stiffness; in the plane only the
  /// first one is used.
  Eigen::Vector3d stiffness = Eigen::Vector3d::Ones();

  [[nodiscard]] double end() const { return begin + length; }
  /// Returns the strain u1, u2 or u3 (field 0, 1 or 2) for a coefficient of 1 of p_0 = 1.
  [[nodiscard]] double strain(Eigen::Index field) const {
    return 1 / std::sqrt(stiffness[field] * length);
  }
  /// Returns the rotation of the frame over the whole element for a coefficient of 1 of p_0 [rad].
  [[nodiscard]] double angle(Eigen::Index field) const {
    return std::sqrt(length / stiffness[field]);
  }
};

/// Returns the length of the longest element.
[[nodiscard]] inline double longest_element(const std::vector<Element>& elements) {
  double longest = 0;
  for (const Element& element : elements) longest = std::max(longest, element.length);
  return longest;
}

/// Number of elements before an arc length at which an element begins or ends.
[[nodiscard]] inline Eigen::Index elements_before(const std::vector<Element>& elements, double s) {
  return std::ranges::count_if(
      elements, [s](const Element& element) { return element.begin + element.length / 2 < s; });
}

}  // namespace dlo::energy_model
