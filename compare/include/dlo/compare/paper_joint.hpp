#pragma once

namespace dlo::compare {

/// Stiffness of a rod to which a joint of the paper's bending law corresponds.
///
/// A joint that rotates by alpha has the potential V = c_b L (8/3 - 4 cos(alpha/2) + 4/3
/// cos^3(alpha/2)), so its moment is
///     M(alpha) = dV/dalpha = c_b L (2 sin(alpha/2) - 2 cos^2(alpha/2) sin(alpha/2))
///              = 2 c_b L sin^3(alpha/2)                          (about c_b L alpha^3 / 4). (1)
/// A joint represents a length L of rod, which the angle alpha bends to the curvature alpha/L. A
/// Hookean rod with that curvature has the moment E I alpha / L. Equal moments give
///     E_equiv I = M L / alpha = 2 c_b L^2 sin^3(alpha/2) / alpha  (about c_b L^2 alpha^2 / 4). (2)
/// The law therefore has no constant modulus: E_equiv vanishes for a straight rod and grows with
/// the square of the angle until the sine limits it (its derivative, the stiffness against a little
/// more bending, is three times as large for small angles). With c_b of Formula 21 for a curvature
/// k, alpha_l = L k,
///     E_equiv / E = alpha_l^2 / alpha (sin(alpha/2) / sin(alpha_l/2))^3, (3)
/// which is alpha_l at the curvature k itself, 1/6 for the paper's Table 5. Moment-matched c_b
/// gives (3) / alpha_l, which is 1 there. If the moment is given, (1) determines the angle. For
/// small angles E_equiv then grows with M^(2/3), and with Formula 21 at a fixed k with L^(1/3):
/// finer polygons are softer.
///
/// The modulus that fits a whole shape best, E* of fit_effective_modulus, is a mean of E_equiv over
/// the shape. For a cantilever under so little weight that all slopes are small it follows in
/// closed form from the moment M_0 = w l^2 / 2 at the clamp, since by (1) the curvature decreases
/// with (1 - s/l)^(2/3), and by Hooke's law with (1 - s/l)^2:
///     E* = small_load_factor E_equiv(M_0),   small_load_factor = <h, h> / <g, h> = 23023/32346 =
///     0.71177
/// with h = (x - (1 - (1-x)^4)/4) / 3 and g = 3/5 (x - 3/8 (1 - (1-x)^(8/3))), the two deflections
/// for M_0 = EI = l = 1 and <,> the integral over x = s/l from 0 to 1.

/// Returns the moment M(alpha), (1) [N m].
/// @param c_b     bending stiffness of the paper's law [N], > 0
/// @param length  L of the segments [m], > 0
/// @param angle   alpha [rad], 0 to pi
/// @throws std::invalid_argument if a number is out of range
[[nodiscard]] double paper_joint_moment(double c_b, double length, double angle);

/// Returns the angle at which a joint has this moment [rad].
/// @param c_b, length  as in paper_joint_moment();  @param moment  [N m], 0 to 2 c_b L
/// @throws std::invalid_argument if a number is out of range
[[nodiscard]] double paper_joint_angle(double c_b, double length, double moment);

/// Returns E_equiv I, (2) [N m^2]; 0 at angle 0. Parameters and errors are those of
/// paper_joint_moment().
[[nodiscard]] double equivalent_bending_stiffness(double c_b, double length, double angle);

}  // namespace dlo::compare
