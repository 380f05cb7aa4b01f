#pragma once

#include <Eigen/Core>
#include <vector>

#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"
#include "kirchhoff/rod_state.hpp"
#include "kirchhoff/surface.hpp"

namespace dlo::energy_model {

/// Strains of a cross-section at s,
///     u = u0(s) + K^-1 R^T m,   K = diag(b1, b2, c).
[[nodiscard]] Eigen::Vector3d strain_of(const RodSection& section, const NaturalStrain& natural,
                                        double s, const RodState& state);

/// The tangent's derivative, R u x t.
[[nodiscard]] Eigen::Vector3d curvature_of(const RodSection& section, const NaturalStrain& natural,
                                           double s, const RodState& state);

/// Stiffness in space, R K R^T.
[[nodiscard]] Eigen::Matrix3d stiffness_of(const RodSection& section, const Eigen::Matrix3d& R);

/// The tangents of states, 3 x states.
[[nodiscard]] Eigen::Matrix3Xd tangents_of(const std::vector<RodState>& states);
[[nodiscard]] std::vector<Eigen::Matrix3d> frames_of(const std::vector<RodState>& states);

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
  double stretch = 0;   ///< of a (n.t)^2 / 2, a the section's stretch
};

/// What the rod's equations need of a piece of it.
struct RodPiece {
  const RodSection& section;
  const NaturalStrain& natural;
  double begin = 0;                  ///< s
  double length = 0;                 ///< to follow
  const Surface* surface = nullptr;  ///< on which it lies, intrinsically straight; null: it is free
};

/// An interval of a mesh, which has to outlive it.
[[nodiscard]] RodPiece piece_of(const RodSpan& span, const RodMesh& mesh, Eigen::Index interval);

/// Derivatives of a cross-section by the arc length at the begin of a piece.
struct RodRate {
  Eigen::Vector3d r;
  Eigen::Vector3d spin;  ///< of R
  Eigen::Vector3d m;
  Eigen::Vector3d n;
};
[[nodiscard]] RodRate rate_of(const RodPiece& piece, const RodState& state);

/// Follows the rod's equations over a piece,
///     r' = t,   R' = R hat(u),   m' = n x t,   n' = -w - f(t), and -w - p N where it lies,
/// and their linearisation,
///     dr' = spin x t,   spin' = R K^-1 R^T (dm + m x spin),   dm' = dn x t + n x (spin x t),
/// f the drag, with GSL's rk8pd. Of a section that stretches by a, in place of t in r' and m', and
/// in dr' and dm' of its change,
///     (1 + a n.t) t   and   (1 + a n.t) spin x t + a (dn.t + n.(spin x t)) t.
/// Nine components of a rotation and no angles, so no chart that could end.
/// @param tolerance  local error per step, relative to 1 + |component|
/// @param[in,out] state, variation  from the beginning of the piece to its end
/// @param[out] integrals  of the piece
/// @return false if the integrator gave up
[[nodiscard]] bool follow_rod(const RodPiece& piece, double tolerance, RodState& state,
                              RodVariation& variation, RodIntegrals& integrals);

/// The same without linearisation.
[[nodiscard]] bool follow_rod(const RodPiece& piece, double tolerance, RodState& state,
                              RodIntegrals& integrals);

}  // namespace dlo::energy_model
