#pragma once

#include <Eigen/Core>

namespace dlo::energy_model {

/// Deflection of a weightless rod by a dead force at its tip; the rod is clamped at the origin
/// along +x. Lengths are in l, energies in EI/l.
struct TipDeflection {
  Eigen::Vector2d tip = Eigen::Vector2d::Zero();  ///< in l
  double tip_angle = 0;                           ///< of the tangent, from +x [rad]
  double clamp_curvature = 0;                     ///< d angle / ds, counter-clockwise positive
  double bending_energy = 0;                      ///< in EI/l
};

/// The elastica in elliptic integrals, with GSL. With phi the tangent's angle against the reversed
/// force, phi'' = -P sin phi is a pendulum: sin(phi/2) = k sin u, u' = sqrt(P) (1 - k^2 sin^2
/// u)^1/2, and the tip, where phi' = 0, is at u = pi/2. The modulus k follows from the length,
///     sqrt(P) = K(k) - F(u_0, k),   k sin u_0 = sin(phi_0/2),
/// and, along and across the reversed force,
///     X = 2 (E(k) - E(u_0, k)) / sqrt(P) - 1,   Y = 2 k cos u_0 / sqrt(P)
/// (Love, Mathematical Theory of Elasticity, art. 262). Of several equilibria it is the one without
/// inflection, which has the lowest energy; a rod pressed along its axis beyond pi^2/4 buckles
/// towards +y.
/// @param load   P l^2 / (EI), in [0, 4e4]: beyond, k'^2 is below what GSL's Carlson functions take
/// @param angle  of the force against +x, any [rad]
[[nodiscard]] TipDeflection tip_deflection(double load, double angle);

}  // namespace dlo::energy_model
