#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "dlo/compare/choice.hpp"
#include "dlo/force_model/stepper.hpp"
#include "paper/printed_tables.hpp"

namespace dlo::compare {

/// Motion of the gripper from 5 s to 13 s of the 28 s of an experiment (paper, Section III).
enum class Movement {
  rotation,    ///< rotation about the third point, in the vertical plane, at a constant rate
  uniform,     ///< translation along +x at a constant speed, stopped at once
  accelerated  ///< translation along +x at a constant acceleration from rest, stopped at once
};

/// Step formula of an experiment.
enum class MovingVariant {
  basic,             ///< Formula 7
  relative,          ///< Formula 18: the tables' rows without "dynamic"
  dynamic,           ///< Formula 20
  dynamic_absolute,  ///< Formulas 17 and 19: "dynamic no rel. limit"
  limited,           ///< Formula 17
  automatic          ///< Formula 20 with c_F and c_h from linear stability
};

/// Names of the movements in tables.
template <>
struct Choices<Movement> {
  /// All movements, in the order of the enumeration.
  static constexpr Choice<Movement> all[] = {{Movement::rotation, "rotation", ""},
                                             {Movement::uniform, "uniform", ""},
                                             {Movement::accelerated, "accelerated", ""}};
};

/// Names of the step formulas in tables.
template <>
struct Choices<MovingVariant> {
  /// All step formulas, in the order of the enumeration.
  static constexpr Choice<MovingVariant> all[] = {
      {MovingVariant::basic, "basic", ""},
      {MovingVariant::relative, "relative", ""},
      {MovingVariant::dynamic, "dynamic", ""},
      {MovingVariant::dynamic_absolute, "dynamic no rel. limit", ""},
      {MovingVariant::limited, "limited", ""},
      {MovingVariant::automatic, "auto", ""}};
};

/// One row of Tables 2 to 4.
struct MovingExperiment {
  Movement movement = Movement::rotation;  ///< movement of the gripper
  bool horizontal = false;  ///< whether the rod is horizontal at the start; otherwise it hangs
  MovingVariant variant = MovingVariant::relative;  ///< step formula

  bool operator==(const MovingExperiment&) const = default;
};

/// Parameters of the experiments that the paper does not print. The defaults are the values that
/// were found by hand to be closest to the printed rows; a report varies them one at a time.
struct MovingAssumptions {
  /// Unit of the lengths in Table 1's c_F (length per newton) and l_s [m]. Every force of the model
  /// is a stiffness times a ratio, so no other entry of the table determines it.
  double length_unit = 0.01;
  /// Force that displaces a gripped point by 5 % of a segment, l/(N-1) [N]: c_e as printed.
  double grip_force = table_1().grip_force;
  double angle = 110 * std::numbers::pi / 180;  ///< angle of the rotation [rad]
  double distance = 0.1;                        ///< distance of the translations [m]
  double c_h = 0.95;  ///< fraction of the previous step that is kept by the variants `dynamic` [-]
  double c_s_change = 0.1;  ///< see force_model::StepOptions
  /// Number of segments by which the rod starts behind its position in the gripper, which then
  /// pulls it forward.
  double start_offset = 0;

  bool operator==(const MovingAssumptions&) const = default;
};

/// Ending of an experiment.
enum class MovingStatus { diverged, too_many_steps, finished };

/// Results of one experiment: the indicators of Tables 2 to 4.
struct [[nodiscard]] MovingRun {
  MovingStatus status = MovingStatus::diverged;  ///< how the experiment ended
  long steps = 0;          ///< evaluations of the model; 112000 if no step was scaled down
  long damped_steps = 0;   ///< steps with c_s != 1
  long limited_steps = 0;  ///< steps with d_m > l_s
  /// Sum of the magnitudes of the spring forces on the gripped points, averaged over the 1 kHz
  /// frames [N]. The springs of a gripper that holds a horizontal rod pull against each other, so
  /// this is more than the net force.
  double average_force = 0;
  /// Magnitude of the sum of the spring forces, averaged over the 1 kHz frames [N].
  double average_net_force = 0;
  double final_force = 0;      ///< average_force of the last frame alone [N]
  double final_net_force = 0;  ///< average_net_force of the last frame alone [N]
  double c_F = 0;              ///< c_F of the last step [m/N]
  double c_h = 0;              ///< c_h of the last step; 0 without dynamics [-]
};

/// Nominal number of steps of every experiment: 28 s at 4000 steps/s.
inline constexpr long nominal_moving_steps = 112000;

/// Pose of the gripper in the rod's plane, with its time derivatives.
struct MovingPose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< position of the third point [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< velocity of the third point [m/s]
  /// Acceleration of the third point [m/s^2].
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
  double angle = 0;       ///< angle of the direction, from +x [rad]
  double angle_rate = 0;  ///< rate of the angle [rad/s]

  /// Returns the direction of the rod in the gripper, with growing arc length, a unit vector [-].
  [[nodiscard]] Eigen::Vector3d direction() const;
};

inline constexpr double movement_begins = 5;  ///< [s]
inline constexpr double movement_ends = 13;   ///< [s]
inline constexpr int moving_frames = 28000;   ///< at 1 kHz, Section II.B
inline constexpr int gripped_point = 2;       ///< index of the third point

/// Returns the weight w l [N] by Table 1: N points of the printed weight.
[[nodiscard]] double moving_weight();

/// Receives a frame of a run: its number, the points [m] (3 x N), and the sum of the spring forces
/// [N].
using MovingObserver =
    std::function<void(int frame, const Eigen::Matrix3Xd& points, const Eigen::Vector3d& force)>;

/// Returns the constants of a step of a variant: Table 1's, completed by the choices.
[[nodiscard]] force_model::StepOptions moving_step_options(MovingVariant variant,
                                                           const MovingAssumptions& choices);

/// Simulates the rod of Table 1 (N = 10, law `paper`) through one experiment, with the catch-up
/// loop of Text 1. A spring grip holds the third and the fourth point, since the third alone could
/// not rotate the rod. A run that needs 5/4 of the nominal steps is stopped; its averages are over
/// the frames that it has computed.
/// @param observe  called after the steps of each frame; may be empty
/// @throws std::invalid_argument if a choice is out of range
MovingRun run_moving_experiment(const MovingExperiment& experiment,
                                const MovingAssumptions& choices,
                                const MovingObserver& observe = {});

/// Physical parameters of a point that follows Formula 19. Rewritten, the formula is
///     P(t+1) - 2 P(t) + P(t-1) = c_F F - (1 - c_h) (P(t) - P(t-1)).
/// This is the Stoermer-Verlet step for points of mass m* = dt^2 / c_F with a damping rate of
/// (1 - c_h) / dt: m* P'' = F - m* (1 - c_h) / dt P'. It does not apply to steps that are scaled
/// down (c_m < 1).
struct PointParameters {
  double mass = 0;  ///< m* [kg]
  /// (1 - c_h) / dt [1/s]; 1 / dt for rows without dynamics, whose c_h is 0.
  double damping_rate = 0;
  /// Drag force divided by velocity, m* (1 - c_h) / dt = (1 - c_h) dt / c_F [N s/m].
  double drag = 0;
};

/// Returns the parameters for steps with these constants, at nominal_moving_steps in 28 s.
/// @param c_F  [m/N], > 0; @param c_h  0 without dynamics [-]
[[nodiscard]] PointParameters point_parameters(double c_F, double c_h);

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
                                               const MovingAssumptions& choices);

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
                                       const MovingAssumptions& choices,
                                       const MovingReference& reference);

}  // namespace dlo::compare
