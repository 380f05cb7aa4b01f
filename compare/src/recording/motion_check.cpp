#include "recording/motion_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/number.hpp"
#include "dlo/compare/error.hpp"
#include "explain/cause_limits.hpp"
#include "motion/motion_misfit.hpp"
#include "motion/moving_scene.hpp"
#include "motion/track.hpp"
#include "recording/gripper_causes.hpp"
#include "recording/motion_residuals.hpp"

namespace dlo::compare {
namespace {

/// Number of points of the rod in each frame: the error of cubics between them is 1e-10 for a
/// smooth rod.
constexpr int model_samples = 201;

Shape rod_shape(const ModelMotion& model, double time, std::vector<double> arc_length) {
  Shape shape{.arc_length = std::move(arc_length), .points = {}};
  shape.points.resize(3, static_cast<Eigen::Index>(shape.arc_length.size()));
  for (Eigen::Index i = 0; i < shape.points.cols(); ++i) {
    shape.points.col(i) = model.at(time, shape.arc_length[static_cast<std::size_t>(i)]);
  }
  return shape;
}

constexpr int fewest_frames = 4;  // as many as a cubic needs
/// Ratio of the model's frame rate to the recording's, which contains nothing faster than half its
/// own rate.
constexpr double frames_per_recorded = 4;
/// Number of frames up to which the scene's own frame rate is used.
constexpr double most_frames_at_scene_rate = 2000;

/// The rod by both models, as far as they exist.
struct Models {
  TrackOptions options;
  std::optional<ModelMotion> at_rest, with_inertia;
  std::string missing_inertia_reason;  // why there is no rod with inertia

  [[nodiscard]] const std::optional<ModelMotion>& of(MotionModel model) const {
    return model == MotionModel::at_rest ? at_rest : with_inertia;
  }
};

TrackOptions track_options(const Scene& scene, const RecordedTimes& times,
                           const MotionCheckRequest& request) {
  const double from = request.from.value_or(recorded_start_time(scene).value_or(times.first));
  if (!(from <= times.first)) {
    throw InputError(
        fmt::format("--from {:g}: after the recording's first time (allowed: up to {:g} s)", from,
                    times.first));
  }
  // Frames of an early recording are compared with the rod at a later time.
  const double to = times.last + lag_range_share * (times.last - times.first);
  const double rate = request.frame_rate.value_or(
      std::max(frames_per_recorded * (times.count - 1) / (times.last - times.first),
               std::min(scene.track.frame_rate, most_frames_at_scene_rate / (to - from))));
  const double frames = std::max<double>(fewest_frames, std::ceil((to - from) * rate));
  TrackOptions options{.from = from,
                       .to = to,
                       .rates = scene.track,
                       .force = ForceModelRun::absent,
                       .samples = model_samples,
                       .solve = request.solve};
  options.rates.frame_rate = frames / (to - from);
  return options;
}

/// Returns the model of the frames; std::nullopt if they are fewer than four or do not reach the
/// recording's end.
template <typename Frames, typename Points>
std::optional<ModelMotion> motion_model(const Frames& frames, const Points& points_of,
                                        const Scene& scene, const TrackOptions& options,
                                        double last) {
  const double step = 1 / options.rates.frame_rate;
  const double end = *options.from + static_cast<double>(frames.size() - 1) * step;
  if (frames.size() < fewest_frames || end < last) return std::nullopt;
  std::vector<Eigen::Matrix3Xd> points;
  points.reserve(frames.size());
  for (const auto& frame : frames) points.push_back(points_of(frame));
  return ModelMotion(*options.from, end, scene.length, std::move(points));
}

std::string stop_text(const std::optional<TrackStop>& stop) {
  return stop ? fmt::format("stopped at {:g} s: {}", stop->time, stop->why) : "has too few frames";
}

/// Adds the rod at rest. Returns why it stopped before its last frame; std::nullopt if it did not,
/// or if it has no first frame and the rod with inertia is judged. @throws ConvergenceError if it
/// has none and is judged
std::optional<TrackStop> add_at_rest(const Scene& scene, double last,
                                     const MotionCheckRequest& request, const Progress& progress,
                                     Models& models) {
  try {
    const Track at_rest = track(scene, models.options, progress);
    models.at_rest = motion_model(
        at_rest.frames, [](const TrackFrame& frame) { return frame.shape.points; }, scene,
        models.options, last);
    return at_rest.stopped;
  } catch (const ConvergenceError&) {
    if (request.model == MotionModel::at_rest) throw;
    return std::nullopt;
  }
}

/// Adds the rod with inertia. If it is judged, the scene has no start, and no time at which it
/// begins in equilibrium is given, the start is fitted to the recording. The rod with inertia needs
/// no equilibria during the motion, which a fast motion of the grippers may not have.
void add_inertia(const Scene& scene, const MarkerMotion& recorded,
                 const MotionCheckRequest& request, Models& models) {
  const TrackOptions& options = models.options;
  try {
    const FrameClock clock(scene, {options.from, options.to}, options.rates);
    const bool is_judged = request.model == MotionModel::with_inertia;
    const bool starts_as_recorded = is_judged && !scene.start && !request.from;
    const MovingScene moving(
        scene, clock, request.damping, request.solve,
        starts_as_recorded ? recorded_start(scene, recorded, request.damping, request.solve)
                           : given_start(scene, clock.time(0), request.damping, request.solve));
    std::vector<double> times;
    for (std::size_t i = 0; i < clock.frames(); ++i) times.push_back(clock.time(i));
    const SimulatedMotion run = moving.run(times, request.solve.terms);
    const std::vector<double> s = equal_arc_lengths(scene.length, options.samples);
    models.with_inertia = motion_model(
        run.moved.frames,
        [&s](const energy_model::MovingFrame& frame) -> Eigen::Matrix3Xd {
          return frame.sample(s).points;
        },
        scene, options, recorded.positions.back().time);
    if (models.with_inertia) return;
    const std::size_t reached = run.moved.frames.size();
    models.missing_inertia_reason = stop_text(
        reached < times.size() ? std::optional(TrackStop{times[reached], run.stop_reason()})
                               : std::nullopt);
  } catch (const ResultError& error) {
    if (request.model == MotionModel::with_inertia) throw;
    models.missing_inertia_reason = error.what();
  }
}

Models run_models(const Scene& scene, const MarkerMotion& recorded,
                  const MotionCheckRequest& request, const Progress& progress) {
  const RecordedTimes times = recorded_times(recorded, scene.length);
  if (times.count < 2) throw InputError(recorded.file + ": one time only (allowed: two or more)");
  Models models{.options = track_options(scene, times, request)};
  if (request.model == MotionModel::with_inertia) require_dynamic(scene);
  const std::optional<TrackStop> stopped =
      add_at_rest(scene, times.last, request, progress, models);
  add_inertia(scene, recorded, request, models);
  if (!models.of(request.model)) {
    throw ConvergenceError(fmt::format("{}: the rod {}", scene.file,
                                       request.model == MotionModel::at_rest
                                           ? stop_text(stopped)
                                           : models.missing_inertia_reason));
  }
  return models;
}

/// Searches for causes that explain a recording. Causes with fewer numbers are tried first; each
/// must leave at most `recording_left` (a path: `path_left`) of the deviation that those before it
/// leave.
class CauseSearch {
 public:
  CauseSearch(const MotionCheck& check, const Models& models, const MarkerMotion& recorded)
      : check_(check), models_(models), recorded_(recorded), least_(check.errors.rms_m) {
    const std::optional<TimeSpan> motion = motion_time_span(check.scene);
    // A rod that rests before the first pose has rested before; the past of a moving rod is not
    // known, nor that of a rod with a given start.
    if (check.scene.start || (motion && motion->begin < *models.options.from))
      earliest_ = *models.options.from;
  }

  /// Returns the lag of the recording relative to a model; std::nullopt as best_lag(), or if the
  /// lag does not explain the deviation of the points from which it is computed.
  [[nodiscard]] std::optional<MotionShift> lag(
      const ModelMotion& model, Displacement displacement = Displacement::none) const {
    const auto best = best_lag(recorded_, model, earliest_, displacement);
    const bool explains =
        best && best->rms_m <= cause_limits::recording_left * best->unshifted_rms_m;
    return explains ? best : std::nullopt;
  }

  [[nodiscard]] std::vector<MotionCause> run(const std::optional<MotionShift>& lag) {
    const ModelMotion& judged = *models_.of(check_.model);
    const MotionModel other =
        check_.model == MotionModel::at_rest ? MotionModel::with_inertia : MotionModel::at_rest;
    const std::optional<ModelMotion>& unlike = models_.of(other);
    const std::string what = other == MotionModel::at_rest
                                 ? "it is quasi-static: its inertia is missing"
                                 : "the rod has inertia (--dynamic)";
    if (unlike) add(MotionCause::Kind::model, what, rms_of(motion_residuals(recorded_, *unlike)));
    if (lag) add(MotionCause::Kind::lag, lag_words(*lag), lag->rms_m);
    if (unlike) {
      const auto late = this->lag(*unlike);
      if (late) add(MotionCause::Kind::model, what + ", and " + lag_words(*late), late->rms_m);
    }
    const MotionShift offset = best_offset(recorded_, judged);
    add(MotionCause::Kind::offset, offset_words(offset), offset.rms_m);
    if (const auto both = this->lag(judged, Displacement::constant)) {
      add(MotionCause::Kind::offset, offset_words(*both) + ", and " + lag_words(*both),
          both->rms_m);
    }
    if (!check_.passes) add_grippers(judged);
    std::ranges::stable_sort(causes_, {}, &MotionCause::rms_m);
    return std::move(causes_);
  }

 private:
  static std::string offset_words(const MotionShift& shift) {
    return fmt::format("the whole recording is displaced by [{:.3g}, {:.3g}, {:.3g}] mm",
                       shift.offset.x() * 1e3, shift.offset.y() * 1e3, shift.offset.z() * 1e3);
  }
  void add(MotionCause::Kind kind, std::string words, double residual_rms) {
    const double largest_share = kind == MotionCause::Kind::gripper_path
                                     ? cause_limits::path_left
                                     : cause_limits::recording_left;
    // A deviation that counts as zero needs no cause.
    if (!(least_ > cause_limits::no_recording_error * check_.scene.length)) return;
    if (!(residual_rms <= largest_share * least_)) return;
    least_ = residual_rms;
    causes_.push_back({kind, std::move(words), residual_rms});
  }
  /// Adds displaced grippers, computed from equilibrium shapes. A rod with inertia follows these if
  /// the path is slow.
  void add_grippers(const ModelMotion& judged) {
    if (!models_.at_rest) return;
    std::vector<MotionCause> found =
        gripper_causes(check_.scene, models_.options, recorded_, *models_.at_rest,
                       motion_residuals(recorded_, judged));
    // Constant displacements come first, then the smallest remaining deviation.
    std::ranges::sort(found, [](const MotionCause& a, const MotionCause& b) {
      return a.kind != b.kind ? a.kind < b.kind : a.rms_m < b.rms_m;
    });
    for (MotionCause& cause : found) add(cause.kind, std::move(cause.words), cause.rms_m);
  }

  const MotionCheck& check_;
  const Models& models_;
  const MarkerMotion& recorded_;
  double least_;
  double earliest_ = -std::numeric_limits<double>::infinity();
  std::vector<MotionCause> causes_;
};

/// Returns the model that is clearly nearer; std::nullopt if neither is.
std::optional<MotionModel> nearer_model(const MotionCheck& check) {
  if (check.at_rest_rms_m <= cause_limits::recording_left * check.with_inertia_rms_m) {
    return MotionModel::at_rest;
  }
  if (check.with_inertia_rms_m <= cause_limits::recording_left * check.at_rest_rms_m) {
    return MotionModel::with_inertia;
  }
  return std::nullopt;
}

void judge_motion(MotionCheck& check) {
  const ShapeTolerance& tolerance = check.tolerance;
  const char* measure = tolerance.largest ? "largest" : "RMS";
  check.judged_m = tolerance.largest ? check.errors.largest_m : check.errors.rms_m;
  check.passes = check.judged_m <= tolerance.allowed_m;
  check.reason = fmt::format(
      "{} {:.4g} mm, allowed {:.4g} mm = {:.3g} % of l{}", measure,
      shown(check.judged_m, check.scene.length) * 1e3, tolerance.allowed_m * 1e3,
      tolerance.allowed_m / check.scene.length * 100, tolerance.by_default ? ", the default" : "");
}

/// Returns the errors after removal of the lag, of frames whose time minus the lag is within the
/// model's frames.
std::vector<FrameError> errors_without_lag(const MarkerMotion& recorded, const ModelMotion& model,
                                           double lag, double length) {
  std::vector<FrameError> frames =
      motion_errors(recorded, motion_residuals(recorded, model, lag), length).frames;
  std::erase_if(frames, [&](const FrameError& frame) {
    return frame.time - lag < model.begin() || frame.time - lag > model.end();
  });
  return frames;
}

/// Returns a frame of a recording with the rod. @param time    of a frame of the recording [s]
/// @param length  of the rod [m]
/// @param lag     delay of the recording [s]; NaN: none
FrameShapes frame_shapes(const MarkerMotion& recorded, const ModelMotion& model, double time,
                         double length, double lag) {
  FrameShapes result{.time = time};
  std::vector<Eigen::Vector3d> points;
  for (const MarkerPosition& at : recorded.positions) {
    if (at.time != time) continue;
    points.push_back(at.position);
    result.recorded.arc_length.push_back(at.arc_length);
  }
  result.recorded.points.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    result.recorded.points.col(static_cast<Eigen::Index>(i)) = points[i];
  }
  result.on_rod = rod_shape(model, time, result.recorded.arc_length);
  result.rod = rod_shape(model, time, equal_arc_lengths(length, model_samples));
  if (std::isfinite(lag)) {
    result.rod_at_other_time =
        rod_shape(model, time - lag, equal_arc_lengths(length, model_samples));
  }
  return result;
}

}  // namespace

MotionCheck check_motion(const Scene& scene, const MarkerMotion& recorded,
                         const MotionCheckRequest& request, const Progress& progress) {
  if (request.tolerance && request.tolerance->deflection_share > 0) {
    throw InputError(
        "a tolerance of deflection: a recorded motion has no single one (allowed: a share of the "
        "length such as 1%, or a length such as \"2 mm\")");
  }
  const Models models = run_models(scene, recorded, request, progress);
  MotionCheck check{.scene = scene,
                    .file = recorded.file,
                    .model = request.model,
                    .damping = request.damping,
                    .begin = *models.options.from,
                    .frame_rate = models.options.rates.frame_rate,
                    .points = recorded.positions.size(),
                    .missing_inertia_reason = models.missing_inertia_reason,
                    .tolerance = request.tolerance.value_or(default_tolerance(scene.length))};
  const auto residuals = [&](MotionModel model) {
    return motion_residuals(recorded, *models.of(model));
  };
  check.errors = motion_errors(recorded, residuals(check.model), scene.length);
  check.at_rest_rms_m = models.at_rest ? rms_of(residuals(MotionModel::at_rest))
                                       : std::numeric_limits<double>::quiet_NaN();
  if (models.with_inertia) check.with_inertia_rms_m = rms_of(residuals(MotionModel::with_inertia));
  check.nearer = nearer_model(check);
  judge_motion(check);
  const ModelMotion& judged = *models.of(check.model);
  if (check.errors.rms_m > cause_limits::no_recording_error * scene.length) {
    CauseSearch search(check, models, recorded);
    const std::optional<MotionShift> lag = search.lag(judged);
    if (lag && lag->rms_m <= cause_limits::recording_left * check.errors.rms_m) {
      check.lag = lag->lag;
      check.lag_rms_m = lag->rms_m;
      check.frames_without_lag = errors_without_lag(recorded, judged, lag->lag, scene.length);
    }
    if (request.explaining == Explaining::yes) check.causes = search.run(lag);
  }
  check.worst_shapes =
      frame_shapes(recorded, judged, check.worst_frame_error().time, scene.length, check.lag);
  return check;
}

}  // namespace dlo::compare
