#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

namespace dlo::energy_model {

/// A section of the rod, in units of the rod.
struct RodSection {
  double bending = 1;  ///< b, its EI over bending_unit(); about d1 where bending_2 is given
  double torsion = 0;  ///< c, its GJ over the same unit; 0: the twist is free and costs nothing
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();  ///< w
  std::optional<double> bending_2 = std::nullopt;    ///< about d2; none: as about d1

  /// About d1, d2 and the tangent.
  [[nodiscard]] Eigen::Vector3d stiffness() const {
    return {bending, bending_2.value_or(bending), torsion};
  }
  /// K^-1; of a twist that is free zero: no torque twists it.
  [[nodiscard]] Eigen::Vector3d compliance() const {
    return {1 / bending, 1 / bending_2.value_or(bending), torsion > 0 ? 1 / torsion : 0.0};
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

/// Natural strains at s, times l; none: a straight rod.
using NaturalStrain = std::function<Eigen::Vector3d(double s)>;

/// Strains of a cross-section at s,
///     u = u0(s) + K^-1 R^T m,   K = diag(b1, b2, c).
[[nodiscard]] Eigen::Vector3d strain_of(const RodSection& section, const NaturalStrain& natural,
                                        double s, const RodState& state);

/// The tangent's derivative, R u x t.
[[nodiscard]] Eigen::Vector3d curvature_of(const RodSection& section, const NaturalStrain& natural,
                                           double s, const RodState& state);

/// Stiffness in space, R K R^T.
[[nodiscard]] Eigen::Matrix3d stiffness_of(const RodSection& section, const Eigen::Matrix3d& R);

/// The rotation by a vector's length about it.
[[nodiscard]] Eigen::Matrix3d rotation_by(const Eigen::Vector3d& turn);

/// A frame turned about its tangent.
[[nodiscard]] Eigen::Matrix3d rolled(const Eigen::Matrix3d& frame, double angle);

/// The frame with a first director, of which the part across the direction counts.
[[nodiscard]] Eigen::Matrix3d frame_of(const Eigen::Vector3d& d1, const Eigen::Vector3d& direction);

/// A frame transported to another tangent by the shortest rotation.
[[nodiscard]] Eigen::Matrix3d transported(const Eigen::Matrix3d& frame,
                                          const Eigen::Vector3d& tangent);

/// The tangents of states, 3 x states.
[[nodiscard]] Eigen::Matrix3Xd tangents_of(const std::vector<RodState>& states);

/// Derivatives of a RodState by some parameters, one a column.
struct RodVariation {
  Eigen::Matrix3Xd r;
  Eigen::Matrix3Xd spin;  ///< of R: dR = spin x R
  Eigen::Matrix3Xd m;
  Eigen::Matrix3Xd n;

  explicit RodVariation(Eigen::Index parameters = 0);
};

/// Integrals over a piece of the rod.
struct RodIntegrals {
  double bending = 0;   ///< of (b1 (u - u0)_1^2 + b2 (u - u0)_2^2) / 2
  double twisting = 0;  ///< of c (u - u0)_3^2 / 2
  double gravity = 0;   ///< of -w . r
  double turn = 0;      ///< of u_3: the frame's turn ahead of transport
};

/// Follows the rod's equations from `begin` over `length`,
///     r' = t,   R' = R hat(u),   m' = n x t,   n' = -w,
/// and their linearisation,
///     dr' = spin x t,   spin' = R K^-1 R^T (dm + m x spin),   dm' = dn x t + n x (spin x t),
/// with GSL's rk8pd. Nine components of a rotation and no angles, so no chart that could end.
/// @param tolerance  local error per step, relative to 1 + |component|
/// @param[in,out] state, variation  from the beginning of the piece to its end
/// @param[out] integrals  of the piece
/// @return false if the integrator gave up
[[nodiscard]] bool follow_rod(const RodSection& section, const NaturalStrain& natural, double begin,
                              double length, double tolerance, RodState& state,
                              RodVariation& variation, RodIntegrals& integrals);

/// The same without linearisation.
[[nodiscard]] bool follow_rod(const RodSection& section, const NaturalStrain& natural, double begin,
                              double length, double tolerance, RodState& state,
                              RodIntegrals& integrals);

}  // namespace dlo::energy_model
