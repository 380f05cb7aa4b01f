#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/shape.hpp"
#include "explain/cause_limits.hpp"
#include "polygon/scalar_search.hpp"
#include "recording/motion_residuals.hpp"
#include "released/hinge_motion.hpp"
#include "suite/cause.hpp"

namespace dlo::compare {
namespace {

constexpr int points_along = 101;
/// Frames of the model per requested frame; cubics interpolate between them.
constexpr int frames_per_requested = 8;
/// End time of the model divided by that of the scene, so that recordings that are faster can be
/// compared.
constexpr double model_time_factor = 1.5;
constexpr int terms = 12;
/// Position of the rod with a cause.
using RodAt = std::function<Eigen::Vector3d(double time, double arc_length)>;

double rms_from(const MarkerMotion& recorded, const RodAt& rod) {
  double sum_of_squares = 0;
  for (const MarkerPosition& at : recorded.positions) {
    sum_of_squares += (at.position - rod(at.time, at.arc_length)).squaredNorm();
  }
  return std::sqrt(sum_of_squares / static_cast<double>(recorded.positions.size()));
}

/// Causes with the RMS distance that each leaves [m].
using CausesLeft = std::vector<std::pair<Cause, double>>;

/// Returns the fitted number of a cause with the RMS distance that it leaves [m]; that is infinite
/// if the best number is at an end of its range. @param residual  distance with a number
Minimum best_parameter(double low, double high, const Function& residual) {
  constexpr int scan_steps = 100;
  const Scan scanned = scan(residual, low, high, scan_steps);
  if (!scanned.is_bracketed()) return {0, std::numeric_limits<double>::infinity()};
  return minimum_near(residual, scanned);
}

CausesLeft plain_causes(const MotionReference& reference, const MarkerMotion& recorded) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const auto residual = [&](const ModelMotion& rod) {
    return rms_from(recorded, [&](double, double s) { return rod.at(0, s); });
  };
  return {
      {{"does not move", none, "it stays where it begins"}, residual(reference.motion)},
      {{"inertia ignored", none, "it is at rest at every time, in the equilibrium of the scene"},
       residual(reference.at_rest)}};
}

CausesLeft fitted_causes(const MotionReference& reference, const MarkerMotion& recorded) {
  CausesLeft causes;
  const ModelMotion& model = reference.motion;
  if (const auto lag =
          best_lag(recorded, model, -std::numeric_limits<double>::infinity(), Displacement::none)) {
    causes.push_back(
        {{"late or early", lag->lag / reference.end_time, lag_words(*lag)}, lag->rms_m});
  }
  const Minimum faster =
      best_parameter(1 / model_time_factor, model_time_factor, [&](double factor) {
        return rms_from(recorded,
                        [&](double time, double s) { return model.at(factor * time, s); });
      });
  causes.push_back(
      {{"frequency wrong", faster.x, fmt::format("all goes {:.4g} times as fast", faster.x)},
       faster.value});
  constexpr double most_e_foldings = 10;  // e-foldings over the whole time
  const Minimum damped = best_parameter(0, most_e_foldings / reference.end_time, [&](double rate) {
    return rms_from(recorded, [&](double time, double s) -> Eigen::Vector3d {
      const Eigen::Vector3d rest = reference.at_rest.at(0, s);
      return rest + std::exp(-rate * time) * (model.at(time, s) - rest);
    });
  });
  const double stays = std::exp(-damped.x * reference.end_time);
  causes.push_back({{"damped", stays,
                     fmt::format("{:.3g} % of the motion is left at the end, and nothing damps the "
                                 "rod",
                                 stays * 100)},
                    damped.value});
  return causes;
}

}  // namespace

MotionReference motion_reference(const BatteryScene& scene) {
  const BatteryMotion& asked = scene.motion.value();
  const double length = scene.scene.length;
  const std::vector<double> s = equal_arc_lengths(length, points_along);
  const double end = model_time_factor * asked.end_time;
  const int count =
      static_cast<int>(std::ceil(model_time_factor * frames_per_requested * (asked.frames - 1))) +
      1;
  ReleasedMotion moved =
      release_rod({scene.scene, asked.begin}, equal_arc_lengths(end, count), s, terms);
  constexpr std::size_t fewest_frames = 4;
  const std::vector<Eigen::Matrix3Xd> at_rest(
      fewest_frames, solve_reference(scene.scene, Model::energy).sample(s).points);
  MotionReference reference{.motion = ModelMotion(0, end, length, std::move(moved.frames)),
                            .length = length,
                            .end_time = asked.end_time,
                            .frames = asked.frames,
                            .at_rest = ModelMotion(0, end, length, at_rest)};
  double sum_of_squares = 0;
  for (const double time : asked.times()) {
    for (const double at : s) {
      sum_of_squares += (reference.motion.at(time, at) - reference.motion.at(0, at)).squaredNorm();
    }
  }
  reference.rms_displacement =
      std::sqrt(sum_of_squares / static_cast<double>(s.size()) / asked.frames);
  return reference;
}

double motion_error(const MotionReference& reference, const MarkerMotion& recorded) {
  const double interval = reference.end_time / (reference.frames - 1);
  constexpr double rounding = 1e-6;
  const RecordedTimes times = recorded_times(recorded, reference.length);
  for (const double end : {times.first, times.last}) {
    if (end >= -rounding * interval && end <= reference.end_time + rounding * interval) continue;
    throw InputError(
        fmt::format("a frame at {:g} s (allowed: 0 to {:g} s)", end, reference.end_time));
  }
  if (2 * times.count < reference.frames || times.first > interval ||
      times.last < reference.end_time - interval) {
    throw InputError(fmt::format(
        "{} frames from {:g} to {:g} s (allowed: {} or more, from 0 to {:g} s, each end within "
        "{:g} s)",
        times.count, times.first, times.last, (reference.frames + 1) / 2, reference.end_time,
        interval));
  }
  return rms_of(motion_residuals(recorded, reference.motion)) / reference.rms_displacement;
}

std::vector<Cause> motion_causes(const MotionReference& reference, const MarkerMotion& recorded) {
  const double error = motion_error(reference, recorded) * reference.rms_displacement;
  if (!(error > error_floor * reference.length)) return {};
  MarkerMotion sparse{.file = recorded.file, .positions = {}};
  constexpr std::size_t sufficient_points = 1000;
  const std::size_t stride = 1 + recorded.positions.size() / sufficient_points;
  for (std::size_t i = 0; i < recorded.positions.size(); i += stride) {
    sparse.positions.push_back(recorded.positions[i]);
  }
  for (const auto& [may_leave, search] :
       {std::pair(cause_limits::state_left, &plain_causes),
        std::pair(cause_limits::fitted_motion_left, &fitted_causes)}) {
    CausesLeft causes = search(reference, sparse);
    const auto best =
        std::ranges::min_element(causes, {}, [](const auto& one) { return one.second; });
    if (best->second <= may_leave * error) return {std::move(best->first)};
  }
  return {};
}

}  // namespace dlo::compare
