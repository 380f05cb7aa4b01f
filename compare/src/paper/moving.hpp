#pragma once

#include <Eigen/Core>
#include <functional>
#include <numbers>

#include "dlo/compare/choice.hpp"
#include "dlo/force_model/stepper.hpp"
#include "paper/printed_tables.hpp"

namespace dlo::compare {

/// What the gripper does from 5 s to 13 s of 28 s (paper, Section III).
enum class Movement {
  rotation,    ///< about the third point, in the vertical plane, at a constant rate
  uniform,     ///< sideways at a constant speed, stopped at once
  accelerated  ///< sideways at a constant acceleration from rest, stopped at once
};

/// How the rod is stepped.
enum class MovingVariant {
  basic,             ///< Formula 7
  relative,          ///< Formula 18: the tables' rows without "dynamic"
  dynamic,           ///< Formula 20
  dynamic_absolute,  ///< Formulas 17 and 19: "dynamic no rel. limit"
  limited,           ///< Formula 17
  automatic          ///< Formula 20 with c_F and c_h from linear stability
};

/// In words, for tables.
template <>
struct Choices<Movement> {
  /// In the enumeration's order.
  static constexpr Choice<Movement> all[] = {{Movement::rotation, "rotation", ""},
                                             {Movement::uniform, "uniform", ""},
                                             {Movement::accelerated, "accelerated", ""}};
};

/// In words, for tables.
template <>
struct Choices<MovingVariant> {
  /// In the enumeration's order.
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
  Movement movement = Movement::rotation;  ///< of the gripper
  bool horizontal = false;                 ///< direction of the rod at the start; else it hangs
  MovingVariant variant = MovingVariant::relative;  ///< of the step

  /// Equal in every choice.
  bool operator==(const MovingExperiment&) const = default;
};

/// What the paper leaves open. The defaults are the nearest choice that was found by hand; a report
/// varies them one at a time.
struct MovingChoices {
  /// What Table 1's c_F (per newton) and l_s are lengths in [m]; every force of the model is a
  /// stiffness times a ratio, so nothing else in the table would tell.
  double length_unit = 0.01;
  /// Force that moves a gripped point by 5 % of a segment, l/(N-1) [N]: c_e as printed.
  double grip_force = table_1().grip_force;
  double angle = 110 * std::numbers::pi / 180;  ///< of the rotation [rad]
  double distance = 0.1;                        ///< of the sideways movements [m]
  double c_h = 0.95;        ///< share of the last movement that is kept, the variants `dynamic` [-]
  double c_s_change = 0.1;  ///< force_model::StepOptions
  /// How many segments the rod starts behind its place in the gripper, which pulls it there.
  double start_offset = 0;

  /// Equal in every choice.
  bool operator==(const MovingChoices&) const = default;
};

/// How an experiment ended.
enum class MovingStatus { diverged, too_many_steps, finished };

/// Indicators of Tables 2 to 4.
struct [[nodiscard]] MovingRun {
  MovingStatus status = MovingStatus::diverged;  ///< how it ended
  long steps = 0;          ///< evaluations of the model; 112000 if none was scaled down
  long damped_steps = 0;   ///< with c_s != 1
  long limited_steps = 0;  ///< with d_m > l_s
  /// Sum of the magnitudes of the spring forces on the gripped points, averaged over the 1 kHz
  /// frames [N]. The springs of a gripper that holds a horizontal rod pull against each other, so
  /// this is more than the net force.
  double average_force = 0;
  double average_net_force = 0;  ///< magnitude of the spring forces' sum [N]
  double final_force = 0;        ///< as average_force, in the last frame [N]
  double final_net_force = 0;    ///< as average_net_force, in the last frame [N]
  double c_F = 0;                ///< of the last step [m/N]
  double c_h = 0;                ///< of the last step; 0 without dynamics [-]
};

/// Nominal steps of every experiment: 28 s at 4000 steps/s.
inline constexpr long nominal_moving_steps = 112000;

/// Where the gripper is, and along which direction it holds the rod, with rates by time.
struct MovingPose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      ///< of the third point [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      ///< [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< [m/s^2]
  double angle = 0;                                        ///< of the direction, from +x [rad]
  double angle_rate = 0;                                   ///< [rad/s]

  /// Along growing arc length, unit [-].
  [[nodiscard]] Eigen::Vector3d direction() const;
};

/// The gripper's pose; at the begin and the end of the movement with the rates after them.
/// @param time  [s]
[[nodiscard]] MovingPose moving_pose(const MovingExperiment& experiment,
                                     const MovingChoices& choices, double time);

inline constexpr double movement_begins = 5;  ///< [s]
inline constexpr double movement_ends = 13;   ///< [s]
inline constexpr int moving_frames = 28000;   ///< at 1 kHz, Section II.B
inline constexpr int gripped_point = 2;       ///< index of the third point

/// The rod's loads and masses, Table 1's: w l [N], as N points of the printed weight.
[[nodiscard]] double moving_weight();

/// A frame of a run: its number, points [m] (3 x N), and the spring forces' sum [N].
using MovingObserver =
    std::function<void(int frame, const Eigen::Matrix3Xd& points, const Eigen::Vector3d& force)>;

/// Constants of one step for a variant: Table 1's, with what the choices fill in.
[[nodiscard]] force_model::StepOptions moving_step_options(MovingVariant variant,
                                                           const MovingChoices& choices);

/// Simulates the rod of Table 1 (N = 10, law `paper`) through one experiment, with the catch-up
/// loop of Text 1. A spring grip holds the third and the fourth point: the third alone could not
/// turn the rod. A run that needs 5/4 of the nominal steps is given up; its averages are over the
/// frames that it reached.
/// @param observe  sees every frame after its steps; null: nothing
/// @throws std::invalid_argument if a choice is out of range
MovingRun run_moving_experiment(const MovingExperiment& experiment, const MovingChoices& choices,
                                const MovingObserver& observe = {});

}  // namespace dlo::compare
