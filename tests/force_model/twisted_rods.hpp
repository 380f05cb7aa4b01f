#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "../helpers.hpp"
#include "dlo/force_model/rod.hpp"

namespace dlo::test {

/// A rod between two clamps that hold the middles of its end segments and the frame. The later
/// clamp is rotated by `turn` about its direction, relative to the frame of the straight rod
/// without twist.
struct TwistedRod {
  double length = 1;      ///< length between the clamps [m]
  double EI = 1;          ///< [N m^2]
  double GJ = 0.8;        ///< [N m^2]
  double c_c = 1e4;       ///< [N]
  int points = 20;        ///< number of points
  double distance = 0.8;  ///< distance of the clamps [m]
  double turn = 0;        ///< rotation of the later clamp about its direction [rad]

  [[nodiscard]] double segment() const { return length / (points - 2); }

  [[nodiscard]] force_model::Rod rod() const {
    const double L = segment();
    force_model::Rod rod;
    rod.rest_lengths.setConstant(points - 1, L);
    rod.c_c = c_c;
    rod.bending = {force_model::BendingLaw::hooke, EI};
    rod.twist.stiffness = GJ;
    rod.loads.setZero(3, points);
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
    const Eigen::Vector3d end = distance * x;
    rod.grips.resize(2);
    rod.grips[0].targets = force_model::grip_targets({0, 0, 0}, x, L, L / 2);
    rod.grips[0].d1 = Eigen::Vector3d::UnitY();
    rod.grips[1].first_point = points - 2;
    rod.grips[1].targets = force_model::grip_targets(end, x, L, L / 2);
    rod.grips[1].reference = end;
    rod.grips[1].d1 = Eigen::AngleAxisd(turn, x) * Eigen::Vector3d::UnitY();
    rod.twist.angles = Eigen::VectorXd::Constant(1, turn);
    return rod;
  }

  /// Returns an arch with straight ends, near the plane of x and y [m].
  [[nodiscard]] Eigen::Matrix3Xd arch() const {
    Eigen::Matrix3Xd shape(3, points);
    const double pi = std::acos(-1);
    // The height of a cosine arch of this length, to second order.
    const double height = 2 / pi * std::sqrt(std::max(0.0, length * (length - distance)));
    for (int i = 0; i < points; ++i) {
      const double s = (i - 0.5) / (points - 2);
      const double out = i < 2 || i + 2 >= points ? 0 : 1 - std::cos(2 * pi * s);
      shape.col(i) << distance * s, height / 2 * out, 0.01 * out * std::sin(2 * s);
    }
    return shape;
  }
};

}  // namespace dlo::test
