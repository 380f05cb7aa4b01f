#pragma once

#include <Eigen/Core>

#include "dlo/force_model/rod.hpp"

namespace dlo::force_model {

/// Stiffness [N/m] of the fastest and the slowest mode: extreme eigenvalues of minus the derivative
/// of the total forces by the positions of the free points.
struct ModeBounds {
  double fastest = 0;  ///< upper bound for this shape
  double slowest = 0;  ///< estimate, > 0 if `fastest` is
};

/// Smallest accepted ratio of the slowest mode to the fastest. Heavy-ball steps keep 1 - 4
/// sqrt(ratio) of a movement, which rounding must not make equal to 1.
inline constexpr double smallest_mode_ratio = 1e-15;

/// Returns bounds for a rod in a given shape.
///
/// `fastest` adds up what can act on one point, the largest value of each: 4 c_c / L of
/// contraction, 16 M'(alpha) / L^2 of bending (hooke: 16 EI / L^3 when straight; paper: 48 c_b
/// sin^2(alpha/2) cos(alpha/2) / L), what turning the joint's forces adds (at most 4 M / L^2, of a
/// natural turn's couple too), twist (twist_mode_bound), walls, solids and spring grips. L is for
/// contraction the rest length of a segment, or its present length if that is shorter, and for
/// bending the present length of the shorter segment of a joint, but never less than a tenth of the
/// rest length.
///
/// `slowest` is the first mode of a straight clamped-free rod of this length and these points,
/// (1.8751 / l)^4 EI L, L the mean rest length and EI that of the softest joint. For the paper's
/// law EI is M L / alpha, alpha the angle of that joint at the moment M = (sum of all |load|) l/2,
/// but at most its moment at 3 rad. The result is limited to smallest_mode_ratio fastest ..
/// fastest.
/// @param points  [m], 3 x rod.points()
/// @throws std::invalid_argument if a shape or number is out of range
[[nodiscard]] ModeBounds mode_bounds(const Rod& rod,
                                     const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// Returns the contribution of walls, solids and spring grips to the bound of the fastest mode
/// [N/m].
[[nodiscard]] double constraint_stiffness(const Rod& rod);

/// Returns the largest stable c_F [m/N] for a fastest mode [N/m]: Formula 15 solved by linear
/// stability, 2 (1 + c_h) / fastest. Above it points oscillate; `c_h` = 0 means no dynamics.
[[nodiscard]] double largest_step_factor(double fastest, double c_h);

/// Constants of Formula 19 for these modes. The formula is Polyak's heavy ball, which converges
/// fastest with
///     c_F = 4 / (sqrt(fastest) + sqrt(slowest))^2,
///     c_h = ((sqrt(fastest) - sqrt(slowest)) / (sqrt(fastest) + sqrt(slowest)))^2
struct HeavyBall {
  double c_F = 0;  ///< step factor: movement divided by force [m/N]
  double c_h = 0;  ///< fraction of the last movement that a step adds [-]
};

/// Returns the constants for these modes. @throws std::invalid_argument unless both are > 0
[[nodiscard]] HeavyBall heavy_ball(const ModeBounds& modes);

}  // namespace dlo::force_model
