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
#include "dlo/compare/shape.hpp"
#include "dlo/compare/shape_verdict.hpp"
#include "motion/moving_scene.hpp"
#include "recording/motion_residuals.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {

/// One frame of a recording and the rod at that time.
struct FrameShapes {
  double time = 0;                         ///< [s]
  Shape recorded;                          ///< the frame's points
  Shape on_rod;                            ///< the rod's points at the same arc lengths
  Shape rod;                               ///< the whole rod
  std::optional<Shape> rod_at_other_time;  ///< the whole rod at time - lag, if there is a lag
};

/// Model with which a recording is compared.
enum class MotionModel {
  at_rest,       ///< equilibrium at every time, see track()
  with_inertia,  ///< rod with inertia, see dynamic_track()
};

/// Names of the models in files.
template <>
struct Choices<MotionModel> {
  /// All values, in the order of the enumeration.
  static constexpr Choice<MotionModel> all[] = {{MotionModel::at_rest, "at_rest", ""},
                                                {MotionModel::with_inertia, "with_inertia", ""}};
};

/// Options of the check of a recorded motion.
struct MotionCheckRequest {
  MotionModel model = MotionModel::at_rest;
  RodDamping damping;  ///< damping of the rod with inertia
  /// Start time of the rod's motion [s]; empty: recorded_start_time() of the scene, else the first
  /// time of the recording.
  std::optional<double> from;
  /// Frame rate of the model, which is interpolated between frames [Hz]; empty: four times that of
  /// the recording, or that of the scene (for up to 2000 frames) if it is higher.
  std::optional<double> frame_rate;
  std::optional<ShapeTolerance> tolerance;  ///< empty: default_tolerance()
  Explaining explaining = Explaining::yes;  ///< pass and fail do not depend on it
  SolveOptions solve;
};

/// A cause that would bring a recording nearer to the rod.
struct MotionCause {
  /// Kinds of causes.
  enum class Kind {
    lag,           ///< the recording is late or early
    offset,        ///< the whole recording is displaced
    model,         ///< the recording has no inertia, or the rod has none
    gripper,       ///< a gripper is displaced
    gripper_path,  ///< a gripper has another path
  };
  Kind kind = Kind::lag;
  std::string words;  ///< a clause, with numbers
  double rms_m = 0;   ///< remaining RMS distance [m]
};

/// Names of the kinds of causes in files.
template <>
struct Choices<MotionCause::Kind> {
  /// All values, in the order of the enumeration.
  static constexpr Choice<MotionCause::Kind> all[] = {
      {MotionCause::Kind::lag, "lag", ""},
      {MotionCause::Kind::offset, "offset", ""},
      {MotionCause::Kind::model, "model", ""},
      {MotionCause::Kind::gripper, "gripper", ""},
      {MotionCause::Kind::gripper_path, "gripper_path", ""}};
};

/// Comparison of a recorded motion with its scene's rod: the result of `dlo check --motion` and of
/// its Python function.
struct MotionCheck {
  Scene scene;
  std::string file;                          ///< name of the recording
  MotionModel model = MotionModel::at_rest;  ///< model that is judged
  RodDamping damping;                        ///< damping of the rod with inertia
  double begin = 0;                          ///< start time of the rod's motion [s]
  double frame_rate = 0;                     ///< frame rate of the model [Hz]
  std::size_t points = 0;                    ///< number of points of the recording, in all frames
  MotionErrors errors;                       ///< distances of the recording
  /// Lag that explains most, and the remaining RMS distance, if it explains a good part; else NaN.
  double lag = std::numeric_limits<double>::quiet_NaN();        ///< [s], > 0: the recording is late
  double lag_rms_m = std::numeric_limits<double>::quiet_NaN();  ///< [m]
  std::vector<FrameError> frames_without_lag;  ///< where the rod is known; empty: no lag
  FrameShapes worst_shapes;                    ///< shapes of the frame with the largest RMS
  double at_rest_rms_m = 0;  ///< RMS distance from the rod at rest [m]; NaN: there is none
  /// RMS distance from the rod with inertia [m]; NaN: there is none, and missing_inertia_reason
  /// states why.
  double with_inertia_rms_m = std::numeric_limits<double>::quiet_NaN();
  std::string missing_inertia_reason;
  std::optional<MotionModel> nearer;  ///< the model that is clearly nearer than the other one
  std::vector<MotionCause> causes;    ///< the best first
  ShapeTolerance tolerance;
  double judged_m = 0;  ///< deviation that was compared with the tolerance [m]
  bool passes = false;
  std::string reason;  ///< one clause

  [[nodiscard]] const FrameError& worst_frame_error() const {
    return errors.frames[errors.worst_frame];
  }
};

/// Compares a recording, by markers (parse_markers()), with the rod that follows the scene's
/// grippers. Points are compared at their own times and arc lengths; the rod is interpolated, not
/// the recording. Both models are computed if the scene allows both; one is judged.
/// @param recorded  in the order of time, then of arc length
/// @throws InputError if the scene neither moves nor has a start, the recording does not belong to
/// it or has fewer than two times, `from` is after its first time, there are too many frames, the
/// tolerance is one of deflection, or the judged model or the rod at rest does not support the
/// scene; ConvergenceError if the judged model does not reach the recording's end
[[nodiscard]] MotionCheck check_motion(const Scene& scene, const MarkerMotion& recorded,
                                       const MotionCheckRequest& request = {},
                                       const Progress& progress = {});

}  // namespace dlo::compare
