#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"
#include "kirchhoff/rod_state.hpp"
#include "kirchhoff/surface.hpp"

namespace dlo::energy_model {

/// Returns the strains of a cross-section at s,
///     u = u0(s) + K^-1 R^T m,   K = diag(b1, b2, c).
[[nodiscard]] Eigen::Vector3d strain_of(const RodSection& section, const NaturalStrain& natural,
                                        double s, const RodState& state);

/// Returns the derivative of the tangent by arc length, (R u) x t.
[[nodiscard]] Eigen::Vector3d curvature_of(const RodSection& section, const NaturalStrain& natural,
                                           double s, const RodState& state);

[[nodiscard]] Eigen::Matrix3Xd tangents_of(const std::vector<RodState>& states);
[[nodiscard]] std::vector<Eigen::Matrix3d> frames_of(const std::vector<RodState>& states);

/// Derivatives of a RodState by parameters, one per column.
struct RodVariation {
  Eigen::Matrix3Xd r;
  Eigen::Matrix3Xd spin;  ///< spin of R: dR = spin x R
  Eigen::Matrix3Xd m;
  Eigen::Matrix3Xd n;

  explicit RodVariation(Eigen::Index parameters = 0);
};

/// Integrals over a piece of the rod.
struct RodIntegrals {
  double bending = 0;   ///< int (b1 (u - u0)_1^2 + b2 (u - u0)_2^2) / 2 ds
  double twisting = 0;  ///< int c (u - u0)_3^2 / 2 ds
  double gravity = 0;   ///< int -w . r ds
  double turn = 0;      ///< int u_3 ds: rotation of the frame from the transported one
  double stretch = 0;   ///< int a (n.t)^2 / 2 ds, a the section's stretch
};

/// Data of a piece of the rod that the rod's equations need.
struct RodElement {
  const RodSection& section;
  const NaturalStrain& natural;
  double begin = 0;   ///< s
  double length = 0;  ///< length to integrate over
  /// Surface on which the piece lies; the piece must then be intrinsically straight. Null: free.
  const Surface* surface = nullptr;
};

/// Returns an interval of a mesh as a piece. Span and mesh have to outlive it.
[[nodiscard]] RodElement rod_element(const RodSpan& span, const RodMesh& mesh,
                                     Eigen::Index interval);

/// Derivatives of a cross-section by the arc length at the begin of a piece.
struct RodRate {
  Eigen::Vector3d r;
  Eigen::Vector3d spin;  ///< spin of R: R' = spin x R
  Eigen::Vector3d m;
  Eigen::Vector3d n;
};
[[nodiscard]] RodRate rate_of(const RodElement& piece, const RodState& state);

/// Integrates the rod's equations over a piece,
///     r' = t,   R' = R hat(u),   m' = n x t,   n' = -w - f(t), and -w - p N where it lies,
/// and their linearisation,
///     dr' = spin x t,   spin' = R K^-1 R^T (dm + m x spin),   dm' = dn x t + n x (spin x t),
/// f the drag, with GSL's rk8pd. If the section stretches by a, t in r', m' and dm' (in dn x t),
/// and spin x t in dr' and dm', are replaced by
///     (1 + a n.t) t   and   (1 + a n.t) spin x t + a (dn.t + n.(spin x t)) t.
/// Rotations are integrated as nine matrix components; a parametrisation by angles would have
/// singularities.
/// @param tolerance  local error per step, relative to 1 + |component|
/// @param[in,out] state, variation  from the begin of the piece to its end
/// @return integrals over the piece; std::nullopt if the integrator failed
[[nodiscard]] std::optional<RodIntegrals> integrate_rod(const RodElement& piece, double tolerance,
                                                        RodState& state, RodVariation& variation);

/// Integrates the rod's equations over a piece without linearisation.
[[nodiscard]] std::optional<RodIntegrals> integrate_rod(const RodElement& piece, double tolerance,
                                                        RodState& state);

}  // namespace dlo::energy_model
