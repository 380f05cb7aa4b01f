#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/check.hpp"
#include "dlo/compare/choice.hpp"
#include "dlo/compare/progress.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_verdict.hpp"
#include "motion/moving_scene.hpp"
#include "recording/frame_shapes.hpp"
#include "recording/motion_residuals.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {

/// What a recording is held against.
enum class MotionModel {
  at_rest,       ///< the rod at rest at every time, as track()
  with_inertia,  ///< the rod with inertia, as dynamic_track()
};

/// In words, for files.
template <>
struct Choices<MotionModel> {
  /// In the enumeration's order.
  static constexpr Choice<MotionModel> all[] = {{MotionModel::at_rest, "at_rest", ""},
                                                {MotionModel::with_inertia, "with_inertia", ""}};
};

/// What is asked of a recorded motion.
struct MotionCheckRequest {
  MotionModel model = MotionModel::at_rest;
  RodDamping damping;                ///< of the rod with inertia
  std::optional<double> from;        ///< when the rod's motion begins [s]; none: the recording's
  std::optional<double> frame_rate;  ///< of the model, between whose frames it is interpolated [Hz]
  std::optional<ShapeTolerance> tolerance;  ///< none: default_tolerance()
  Explaining explaining = Explaining::yes;  ///< pass and fail do not depend on it
  SolveOptions solve;
};

/// What would bring a recording nearer to the rod.
struct MotionCause {
  /// What it is.
  enum class Kind {
    lag,           ///< the recording is late
    offset,        ///< all of it is displaced
    model,         ///< it has no inertia, or the rod has none
    gripper,       ///< a gripper is displaced
    gripper_path,  ///< a gripper's path is another one
  };
  Kind kind = Kind::lag;
  std::string words;  ///< a clause, with numbers
  double rms_m = 0;   ///< that is left [m]
};

/// In words, for files.
template <>
struct Choices<MotionCause::Kind> {
  /// In the enumeration's order.
  static constexpr Choice<MotionCause::Kind> all[] = {
      {MotionCause::Kind::lag, "lag", ""},
      {MotionCause::Kind::offset, "offset", ""},
      {MotionCause::Kind::model, "model", ""},
      {MotionCause::Kind::gripper, "gripper", ""},
      {MotionCause::Kind::gripper_path, "gripper_path", ""}};
};

/// A recorded motion against its scene's rod, judged: what `dlo check --motion` says, and Python
/// with it.
struct MotionCheck {
  Scene scene;
  std::string file;                          ///< the recording's
  MotionModel model = MotionModel::at_rest;  ///< that it was held against
  RodDamping damping;                        ///< of the rod with inertia
  double begin = 0;                          ///< of the rod's motion [s]
  double frame_rate = 0;                     ///< of the model [Hz]
  std::size_t points = 0;                    ///< of the recording, in all frames
  MotionErrors errors;                       ///< of the recording
  /// Lag that explains most, and the RMS that is left, where it explains a good part; NaN: none.
  double lag = std::numeric_limits<double>::quiet_NaN();        ///< [s], > 0: the recording is late
  double lag_rms_m = std::numeric_limits<double>::quiet_NaN();  ///< [m]
  std::vector<FrameError> frames_without_lag;  ///< as far as the rod is known; empty: no lag
  FrameShapes worst_shapes;                    ///< of the worst frame
  double at_rest_rms_m = 0;                    ///< from the rod at rest [m]
  /// From the rod with inertia [m]; NaN: there is none, and why.
  double with_inertia_rms_m = std::numeric_limits<double>::quiet_NaN();
  std::string no_inertia;
  std::optional<MotionModel> nearer;  ///< that of the two which is nearer by far
  std::vector<MotionCause> causes;    ///< the best first
  ShapeTolerance tolerance;
  double judged_m = 0;  ///< that was held against the tolerance [m]
  bool passes = false;
  std::string reason;  ///< one clause

  /// The frame with the largest RMS.
  [[nodiscard]] const FrameError& worst() const { return errors.frames[errors.worst_frame]; }
};

/// A cause is one if it takes at least half of the mean square distance.
inline constexpr double cause_may_leave = 0.7;

/// Holds a recording, by markers (parse_markers()), against the rod that follows the
/// scene's grippers. Points are compared at their own times and arc lengths; the rod is
/// interpolated, not the recording. Both models are run where the scene allows both; one is judged.
/// @param recorded  by time, then by arc length
/// @throws InputError if the scene does not move, the recording is not of it, or has less than two
/// times; ConvergenceError if the model that is judged does not come to the recording's end
[[nodiscard]] MotionCheck check_motion(const Scene& scene, const MarkerMotion& recorded,
                                       const MotionCheckRequest& request = {},
                                       const Progress& progress = {});

}  // namespace dlo::compare
