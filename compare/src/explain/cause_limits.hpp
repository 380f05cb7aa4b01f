#pragma once

namespace dlo::compare::cause_limits {

// Thresholds of all searches for causes: of `check` (explain_shape), of the results tables of
// simulators (causes_of, motion_causes) and of `check --motion` (check_motion). A fraction is of
// the RMS deviation to explain.

/// `check`: largest fraction that a cause may leave. A cause that leaves more explains less than
/// what remains.
inline constexpr double check_left = 0.5;
/// `check`: fraction of the remaining deviation that each additional number must remove, since any
/// number that is fitted removes some.
inline constexpr double required_reduction_per_parameter = 0.5;
/// `check`: deviations below this fraction, or below this share of the length, count as equal; fits
/// take them as the noise of the points.
inline constexpr double equality_share = 0.02;
inline constexpr double equality_length_share = 1e-5;
/// `check`: deviation, divided by the length, above which a shape is simply another one, so that a
/// fraction of it is no small deviation.
inline constexpr double different_shape_share = 0.05;
/// `check`: distance out of plane, divided by the length, above which a rod has left its plane. It
/// is far above the energy model's error of 1e-9.
inline constexpr double out_of_plane = 1e-3;

/// Tables: largest fraction that a chain of hinges with EI/h may leave, which has no fitted number.
inline constexpr double chain_left = 0.05;
/// Tables: largest fraction that another equilibrium, or a motion without a fitted number, may
/// leave. Equilibria are far apart, so a larger fraction than without_left distinguishes them.
inline constexpr double state_left = 0.1;
/// Tables: largest fraction that the scene without one of its properties may leave. It is small
/// because a shape that has hardly moved is also close to that scene's.
inline constexpr double without_left = 0.03;
/// Tables: largest fraction that a cause may leave if more points confirm it: the shapes converge
/// to it, or a finer shape satisfies fitted_left. The rest is discretisation error.
inline constexpr double coarse_left = 0.3;
/// Tables: largest fraction that a cause with a fitted number may leave. It is small because any
/// fitted number reduces the error.
inline constexpr double fitted_left = 0.02;
/// Tables: largest fraction that a cause may leave if the shape is out of balance, which the cause
/// must explain too.
inline constexpr double unbalanced_left = 2e-3;
/// Tables: largest fraction that a motion with a fitted number may leave. It is larger than
/// fitted_left because one number hardly fits many times by accident.
inline constexpr double fitted_motion_left = 0.3;
/// Tables: order from which a simulator converges with second order, up to which it does not
/// converge to the rod, and from which shapes approach another rod. The last one is smaller than
/// the first since boundary layers may hardly be resolved.
inline constexpr double second_order = 1.6;
inline constexpr double nonconverging_order = 0.4;
inline constexpr double approaching_order = 1.2;
/// Tables: imbalance of the moments above which a shape is not at rest.
inline constexpr double rest_imbalance_limit = 0.02;
/// Tables: error that needs no cause, divided by the length: 1e-3 of the default tolerance. The
/// thickness of a real rod causes errors of this size.
inline constexpr double negligible_error = 1e-5;

/// `check --motion`: largest fraction of the deviation that a cause may leave; the deviation is
/// what the causes before it leave. It then explains half of the mean square distance. It is larger
/// than check_left because no cause removes the noise of a recording.
inline constexpr double recording_left = 0.7;
/// `check --motion`: largest fraction that another path of a gripper may leave of the deviation
/// that the causes before it leave. It is small because a path has three numbers per frame.
inline constexpr double path_left = 0.35;
/// `check --motion`: errors, divided by the length, that count as zero: those of the interpolation
/// where accelerations jump.
inline constexpr double no_recording_error = 1e-5;

}  // namespace dlo::compare::cause_limits
