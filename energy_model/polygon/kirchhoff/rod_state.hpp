#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "dlo/energy_model/drag.hpp"

namespace dlo::energy_model {

/// Natural strains at s, times l; none: a straight rod.
using NaturalStrain = std::function<Eigen::Vector3d(double s)>;

/// A section of the rod, in units of the rod.
struct RodSection {
  double bending = 1;  ///< b, its EI over bending_unit(); about d1 where bending_2 is given
  double torsion = 0;  ///< c, its GJ over the same unit; 0: the twist is free and costs nothing
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();            ///< w, with line loads, at s = 0
  std::optional<double> bending_2 = std::nullopt;              ///< about d2; none: as about d1
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();             ///< w'
  std::optional<Eigen::Vector2d> natural_bend = std::nullopt;  ///< its own; none: the rod's
  std::optional<double> natural_twist = std::nullopt;          ///< as natural_bend
  std::optional<Drag> drag = std::nullopt;                     ///< of forces in units of the rod
  double stretch = 0;  ///< EI / (EA l^2): the tangent's stretch by the tension; 0: none

  [[nodiscard]] Eigen::Vector3d weight_from(double s, double length) const {
    return length * (weight + (s + length / 2) * slope);
  }

  /// About d1, d2 and the tangent.
  [[nodiscard]] Eigen::Vector3d stiffness() const {
    return {bending, bending_2.value_or(bending), torsion};
  }
  /// K^-1; of a twist that is free zero: no torque twists it.
  [[nodiscard]] Eigen::Vector3d compliance() const {
    return {1 / bending, 1 / bending_2.value_or(bending), torsion > 0 ? 1 / torsion : 0.0};
  }
  /// Natural strains at s, of which the section may have its own: at its ends too, where another
  /// one begins.
  /// @param of_rod  not none
  [[nodiscard]] Eigen::Vector3d natural(const NaturalStrain& of_rod, double s) const {
    Eigen::Vector3d u = of_rod(s);
    if (natural_bend) u.head<2>() = *natural_bend;
    if (natural_twist) u.z() = *natural_twist;
    return u;
  }
};

/// Cross-section of an inextensible Kirchhoff rod with material directors, in units of its length
/// and stiffness (l, EI/l, EI/l^2).
struct RodState {
  Eigen::Vector3d r = Eigen::Vector3d::Zero();      ///< position
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  ///< columns d1, d2 and the tangent t
  Eigen::Vector3d m = Eigen::Vector3d::Zero();  ///< moment of what lies beyond on what lies before
  Eigen::Vector3d n = Eigen::Vector3d::Zero();  ///< force of what lies beyond on what lies before

  [[nodiscard]] Eigen::Vector3d t() const { return R.col(2); }
};

}  // namespace dlo::energy_model
