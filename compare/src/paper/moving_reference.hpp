#pragma once

#include <limits>
#include <string>
#include <vector>

#include "paper/moving.hpp"

namespace dlo::compare {

/// What Formula 19 says of points, read as physics. Rewritten it is
///     P(t+1) - 2 P(t) + P(t-1) = c_F F - (1 - c_h) (P(t) - P(t-1)),
/// Stoermer's and Verlet's step for points of mass m* = dt^2 / c_F that are slowed down at the rate
/// (1 - c_h) / dt: m* P'' = F - m* (1 - c_h) / dt P'. Steps that are scaled down (c_m < 1) are not.
struct PointReading {
  double mass = 0;          ///< m* [kg]
  double damping_rate = 0;  ///< (1 - c_h) / dt [1/s]; of rows without dynamics 1 / dt: c_h is 0
  /// Force by velocity, m* (1 - c_h) / dt = (1 - c_h) dt / c_F [N s/m].
  double drag = 0;
};

/// Of steps with these constants, nominal_moving_steps in 28 s.
/// @param c_F  [m/N], > 0; @param c_h  0 without dynamics [-]
[[nodiscard]] PointReading point_reading(double c_F, double c_h);

/// Share of critical damping that the reference has in its first mode, from its material: the
/// paper says nothing of damping [-].
inline constexpr double reference_damping_ratio = 0.05;

/// Bending stiffness of the reference [N m^2]: that of a rod whose moment the law `paper` has at
/// the angle of 2.5 degrees a joint, which Table 1's c_b is made for.
[[nodiscard]] double reference_bending_stiffness();

/// The rod of Table 1 by the dynamic energy model (dlo::energy_model::simulate), through one
/// movement: a rod of its length, mass and weight, clamped in the middle of the segment that the
/// gripper holds.
struct MovingReference {
  bool converged = false;
  std::string message;                   ///< why not
  std::vector<int> frames;               ///< numbers, from the begin of the movement on
  std::vector<Eigen::Matrix3Xd> points;  ///< at the arc lengths of the model's points [m], by frame
  std::vector<Eigen::Vector3d> forces;   ///< of the gripper on the rod [N], by frame
  double energy_error = 0;               ///< dlo::energy_model::Dynamics::energy_error
};

/// Every 50 ms from 25 ms after the begin of the movement on, of the experiment's movement and rod.
[[nodiscard]] MovingReference moving_reference(const MovingExperiment& experiment,
                                               const MovingChoices& choices);

/// How far a run is from the reference, over the reference's frames.
struct MovingError {
  double shape_rms = 0;  ///< root mean square over points and frames, over the length [-]
  double shape_max = 0;  ///< largest distance of a point, over the length [-]
  double force_rms = 0;  ///< of the difference of the net forces, over frames [N]
  double force_max = 0;  ///< largest [N]
};

/// Runs the experiment again beside the reference; infinite errors if it does not finish.
[[nodiscard]] MovingError moving_error(const MovingExperiment& experiment,
                                       const MovingChoices& choices,
                                       const MovingReference& reference);

}  // namespace dlo::compare
