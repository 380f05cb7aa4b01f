#pragma once

#include <cmath>

#include "../helpers.hpp"
#include "dlo/force_model/rod.hpp"

namespace dlo::test {

/// The paper's spring steel rod (Table 5), held at the origin, with points and weights as for
/// compare::Bookkeeping::consistent.
struct SteelRod {
  double length = 0.5;
  double EI = 0.16493361431346418;
  double AE = 659734.4572538566;
  double weight_per_length = 0.24347028571428571;
  double angle = 0;
  int points = 16;

  [[nodiscard]] double segment() const { return length / (points - 1.5); }
  [[nodiscard]] Eigen::Vector3d direction() const { return {std::cos(angle), std::sin(angle), 0}; }

  [[nodiscard]] force_model::Rod rod(const force_model::Bending& bending, double c_c) const {
    force_model::Rod rod;
    rod.rest_lengths = Eigen::VectorXd::Constant(points - 1, segment());
    rod.c_c = c_c;
    rod.bending = bending;
    rod.loads.setZero(3, points);
    for (int i = 1; i < points; ++i) {
      rod.loads(1, i) = -weight_per_length * segment() * (i + 1 == points ? 0.5 : 1);
    }
    force_model::Grip grip;
    grip.targets = force_model::grip_targets({0, 0, 0}, direction(), segment(), segment() / 2);
    rod.grips = {grip};
    return rod;
  }

  [[nodiscard]] Eigen::Matrix3Xd straight() const {
    Eigen::Matrix3Xd points_along(3, points);
    for (int i = 0; i < points; ++i) points_along.col(i) = (i - 0.5) * segment() * direction();
    return points_along;
  }
};

/// Returns the root mean square of the distances of points.
inline double rms_distance(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a - b).norm() / std::sqrt(static_cast<double>(a.cols()));
}

}  // namespace dlo::test
