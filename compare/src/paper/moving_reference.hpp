#pragma once

#include <limits>
#include <string>
#include <vector>

#include "paper/moving.hpp"

namespace dlo::compare {

/// Physical parameters of a point that follows Formula 19. Rewritten, the formula is
///     P(t+1) - 2 P(t) + P(t-1) = c_F F - (1 - c_h) (P(t) - P(t-1)).
/// This is the Stoermer-Verlet step for points of mass m* = dt^2 / c_F with a damping rate of
/// (1 - c_h) / dt: m* P'' = F - m* (1 - c_h) / dt P'. It does not apply to steps that are scaled
/// down (c_m < 1).
struct PointReading {
  double mass = 0;  ///< m* [kg]
  /// (1 - c_h) / dt [1/s]; 1 / dt for rows without dynamics, whose c_h is 0.
  double damping_rate = 0;
  /// Drag force divided by velocity, m* (1 - c_h) / dt = (1 - c_h) dt / c_F [N s/m].
  double drag = 0;
};

/// Returns the parameters for steps with these constants, at nominal_moving_steps in 28 s.
/// @param c_F  [m/N], > 0; @param c_h  0 without dynamics [-]
[[nodiscard]] PointReading point_reading(double c_F, double c_h);

/// Material damping of the reference, as a fraction of the critical damping of its first mode. The
/// paper does not state any damping [-].
inline constexpr double reference_damping_ratio = 0.05;

/// Returns the bending stiffness of the reference [N m^2]: that of a rod with the moment of the law
/// `paper` at the angle of 2.5 degrees per joint for which Table 1's c_b was chosen.
[[nodiscard]] double reference_bending_stiffness();

/// Motion of Table 1's rod by the dynamic energy model (dlo::energy_model::simulate), through one
/// movement. The rod has the same length, mass and weight, and is clamped in the middle of the
/// segment that the gripper holds.
struct MovingReference {
  bool converged = false;
  std::string message;      ///< reason if it has not converged
  std::vector<int> frames;  ///< compared frames of the experiment; none before the movement begins
  /// Points of the rod at the arc lengths of the force model's points [m], per frame.
  std::vector<Eigen::Matrix3Xd> points;
  std::vector<Eigen::Vector3d> forces;  ///< force of the gripper on the rod [N], per frame
  double energy_error = 0;              ///< dlo::energy_model::Dynamics::energy_error
};

/// Computes the reference of the experiment's movement and rod, every 50 ms, beginning 25 ms after
/// the beginning of the movement.
[[nodiscard]] MovingReference moving_reference(const MovingExperiment& experiment,
                                               const MovingChoices& choices);

/// Distance of a run from the reference, over the reference's frames.
struct MovingError {
  double shape_rms = 0;  ///< root mean square over points and frames, divided by the length [-]
  double shape_max = 0;  ///< largest distance of a point, divided by the length [-]
  double force_rms = 0;  ///< root mean square over frames of the difference of the net forces [N]
  double force_max = 0;  ///< largest difference of the net forces [N]
};

/// Repeats the experiment and compares it with the reference; all errors are infinite if the
/// experiment or the reference did not finish.
[[nodiscard]] MovingError moving_error(const MovingExperiment& experiment,
                                       const MovingChoices& choices,
                                       const MovingReference& reference);

}  // namespace dlo::compare
