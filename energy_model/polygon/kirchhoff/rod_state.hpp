#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "dlo/energy_model/drag.hpp"

namespace dlo::energy_model {

/// Natural strains at s, times l; empty: a straight rod.
using NaturalStrain = std::function<Eigen::Vector3d(double s)>;

/// Section of the rod, in units of the rod.
struct RodSection {
  double bending = 1;  ///< b: EI over bending_unit(); about d1 if bending_2 is given
  double torsion = 0;  ///< c: GJ over bending_unit(); 0: twist is free and has no energy
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();  ///< w, including line loads, at s = 0
  std::optional<double> bending_2 = std::nullopt;    ///< stiffness about d2; none: as about d1
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();   ///< derivative w' of the weight
  /// Natural curvature; none: the rod's.
  std::optional<Eigen::Vector2d> natural_bend = std::nullopt;
  std::optional<double> natural_twist = std::nullopt;  ///< natural twist; none: the rod's
  std::optional<Drag> drag = std::nullopt;             ///< drag, with forces in units of the rod
  double stretch = 0;  ///< EI / (EA l^2): stretch of the tangent per tension; 0: inextensible

  [[nodiscard]] Eigen::Vector3d weight_of_interval(double s, double length) const {
    return length * (weight + (s + length / 2) * slope);
  }

  /// Returns K, the stiffness about d1, d2 and the tangent.
  [[nodiscard]] Eigen::Vector3d stiffness() const {
    return {bending, bending_2.value_or(bending), torsion};
  }
  /// Returns K^-1; zero for free twist, because no torque twists the rod.
  [[nodiscard]] Eigen::Vector3d compliance() const {
    return {1 / bending, 1 / bending_2.value_or(bending), torsion > 0 ? 1 / torsion : 0.0};
  }
  /// Returns the natural strains at s, of which the section may have its own. Its own are also used
  /// at its ends, where another section may begin.
  /// @param of_rod  not empty
  [[nodiscard]] Eigen::Vector3d natural(const NaturalStrain& of_rod, double s) const {
    Eigen::Vector3d u = of_rod(s);
    if (natural_bend) u.head<2>() = *natural_bend;
    if (natural_twist) u.z() = *natural_twist;
    return u;
  }
};

/// Cross-section of a Kirchhoff rod with material directors, in units of its length and stiffness
/// (l, EI/l, EI/l^2).
struct RodState {
  Eigen::Vector3d r = Eigen::Vector3d::Zero();      ///< position
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  ///< columns d1, d2 and the tangent t
  Eigen::Vector3d m = Eigen::Vector3d::Zero();  ///< moment of the part beyond on the part before
  Eigen::Vector3d n = Eigen::Vector3d::Zero();  ///< force of the part beyond on the part before

  [[nodiscard]] Eigen::Vector3d t() const { return R.col(2); }
};

}  // namespace dlo::energy_model
