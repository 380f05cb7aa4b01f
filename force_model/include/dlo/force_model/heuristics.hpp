#pragma once

namespace dlo::force_model {

/// Returns the relative force that bends a rod of N points to a quarter circle (paper, Formula 9):
/// (1 - cos a) sqrt((1 - cos a) / 2), a = (pi/2) / (N-1) [-].
/// @throws std::invalid_argument unless points >= 3
[[nodiscard]] double quarter_circle_force(int points);

/// Smallest quarter circle for a joint angle (paper, Formula 10).
struct QuarterCircle {
  double radius = 0;    ///< R = 1/2 l/(N-1) / sin(alpha/2) [m]. The paper calls it a diameter.
  double segments = 0;  ///< n_b = (pi/2) / alpha [-]
};

/// Computes the smallest quarter circle.
/// @param length  l [m], > 0;  @param points  N >= 3;  @param alpha  [rad], 0 < alpha < pi
[[nodiscard]] QuarterCircle smallest_quarter_circle(double length, int points, double alpha);

/// Returns the number of points that a bend of radius `radius` needs so that no joint angle exceeds
/// `alpha` (Formula 10 solved for N), at least five as in the paper.
/// @throws std::invalid_argument if an argument is out of range
[[nodiscard]] int points_for_radius(double length, double radius, double alpha);

/// Returns c_c [N] such that `force` lengthens the rod by `percent` (paper, Formula 11): F 100 /
/// percent.
/// @throws std::invalid_argument unless both are > 0
[[nodiscard]] double contraction_stiffness(double force, double percent);

/// Returns c_c [N] for the rod's own weight (Formula 12): m g 100 / percent.
/// @param mass  [kg];  @param gravity  [m/s^2];  @param percent  3 to 5 in the paper
/// @throws std::invalid_argument unless all are > 0
[[nodiscard]] double contraction_stiffness(double mass, double gravity, double percent);

/// Trigonometric factor of Formula 13.
enum class Formula13 {
  printed,  ///< sin(pi - alpha), as in the paper
  table_1,  ///< cos(alpha), which reproduces the c_b of Table 1 to every printed digit
};

/// Returns c_b [N] such that `force` bends a joint by `alpha` (paper, Formula 13).
/// @param force  F_bl [N], > 0;  @param alpha  alpha_l [rad], 0 < alpha < pi/2
[[nodiscard]] double bending_stiffness(double force, double alpha, Formula13 variant);

/// Returns c_e [N/m] of a gripper spring that is displaced by `distance` under the rod's weight
/// (Formula 14).
/// @param weight  m g [N], > 0;  @param distance  G_d [m], > 0: in the paper 1 to 2 % of a segment
[[nodiscard]] double grip_stiffness(double weight, double distance);

}  // namespace dlo::force_model
