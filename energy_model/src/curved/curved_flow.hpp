#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "kirchhoff/rod_flow.hpp"

namespace dlo::energy_model {

/// Cross-section of an inextensible Kirchhoff rod with material directors, in units of its length
/// and stiffness (l, EI/l, EI/l^2).
struct CurvedState {
  Eigen::Vector3d r = Eigen::Vector3d::Zero();      ///< position
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  ///< columns d1, d2 and the tangent t
  Eigen::Vector3d m = Eigen::Vector3d::Zero();  ///< moment of what lies beyond on what lies before
  Eigen::Vector3d n = Eigen::Vector3d::Zero();  ///< force of what lies beyond on what lies before

  [[nodiscard]] Eigen::Vector3d t() const { return R.col(2); }
};

/// Natural strains at s, times l.
using NaturalStrain = std::function<Eigen::Vector3d(double s)>;

/// Strains of a cross-section at s,
///     u = u0(s) + K^-1 R^T m,   K = diag(b1, b2, c).
[[nodiscard]] Eigen::Vector3d strain_of(const RodSection& section, const NaturalStrain& natural,
                                        double s, const CurvedState& state);

/// Stiffness in space, R K R^T.
[[nodiscard]] Eigen::Matrix3d stiffness_of(const RodSection& section, const Eigen::Matrix3d& R);

/// The rotation by a vector's length about it.
[[nodiscard]] Eigen::Matrix3d rotation_by(const Eigen::Vector3d& turn);

/// Derivatives of a CurvedState by some parameters, one a column.
struct CurvedVariation {
  Eigen::Matrix3Xd r;
  Eigen::Matrix3Xd spin;  ///< of R: dR = spin x R
  Eigen::Matrix3Xd m;
  Eigen::Matrix3Xd n;

  explicit CurvedVariation(Eigen::Index parameters = 0);
};

/// Integrals over a piece of the rod.
struct CurvedIntegrals {
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
[[nodiscard]] bool follow_curved(const RodSection& section, const NaturalStrain& natural,
                                 double begin, double length, double tolerance, CurvedState& state,
                                 CurvedVariation& variation, CurvedIntegrals& integrals);

}  // namespace dlo::energy_model
