#pragma once

#include <Eigen/Core>
#include <functional>
#include <numbers>

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
  bool horizontal = false;  ///< the rod is horizontal at the start; otherwise it hangs
  MovingVariant variant = MovingVariant::relative;  ///< step formula

  /// Whether all members are equal.
  bool operator==(const MovingExperiment&) const = default;
};

/// Parameters of the experiments that the paper does not print. The defaults are the values that
/// were found by hand to be closest to the printed rows; a report varies them one at a time.
struct MovingChoices {
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

  /// Whether all members are equal.
  bool operator==(const MovingChoices&) const = default;
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
  /// Magnitude of the sum of the spring forces, averaged likewise [N].
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

/// Returns the gripper's pose. At the beginning and the end of the movement its rates are those
/// just after.
/// @param time  [s]
[[nodiscard]] MovingPose moving_pose(const MovingExperiment& experiment,
                                     const MovingChoices& choices, double time);

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
                                                           const MovingChoices& choices);

/// Simulates the rod of Table 1 (N = 10, law `paper`) through one experiment, with the catch-up
/// loop of Text 1. A spring grip holds the third and the fourth point, since the third alone could
/// not rotate the rod. A run that needs 5/4 of the nominal steps is stopped; its averages are over
/// the frames that it has computed.
/// @param observe  called after the steps of each frame; may be empty
/// @throws std::invalid_argument if a choice is out of range
MovingRun run_moving_experiment(const MovingExperiment& experiment, const MovingChoices& choices,
                                const MovingObserver& observe = {});

}  // namespace dlo::compare
