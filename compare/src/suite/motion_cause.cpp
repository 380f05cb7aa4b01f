#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/shape.hpp"
#include "polygon/scalar_search.hpp"
#include "recording/motion_residuals.hpp"
#include "released/hinge_motion.hpp"
#include "suite/cause.hpp"

namespace dlo::compare {
namespace {

constexpr int points_along = 101;
/// Frames of the model per requested frame; cubics interpolate between them.
constexpr int frames_per_asked = 8;
/// End time of the model divided by that of the scene, so that recordings that are faster can be
/// compared.
constexpr double beyond = 1.5;
constexpr int terms = 12;
/// Largest fraction of the error that a cause may leave: without a fitted number, and with one.
constexpr double may_leave_plain = 0.1;
constexpr double may_leave_fitted = 0.3;

/// Position of the rod with a cause.
using RodAt = std::function<Eigen::Vector3d(double time, double arc_length)>;

double rms_from(const MarkerMotion& recorded, const RodAt& rod) {
  double squares = 0;
  for (const MarkerPosition& at : recorded.positions) {
    squares += (at.position - rod(at.time, at.arc_length)).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(recorded.positions.size()));
}

/// Fitted number of a cause, and the RMS error that it leaves [m].
struct Fitted {
  double value = 0;
  double left = std::numeric_limits<double>::infinity();
};

Fitted best_of(const MarkerMotion& recorded, double low, double high,
               const std::function<RodAt(double)>& rod_with) {
  constexpr int steps = 100;
  const Function left = [&](double value) { return rms_from(recorded, rod_with(value)); };
  const Scan seen = scan(left, low, high, steps);
  if (!seen.is_bracketed()) return {};
  const Minimum found = minimum_near(left, seen);
  return {found.x, found.value};
}

/// Returns the causes without a fitted number, with the error that each leaves [m].
std::vector<std::pair<Cause, double>> plain_causes(const MotionReference& reference,
                                                   const MarkerMotion& recorded) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::pair<Cause, double>> causes;
  causes.emplace_back(
      Cause{.name = "does not move", .factor = none, .words = "it stays where it begins"},
      rms_from(recorded, [&](double, double s) { return reference.motion.at(0, s); }));
  causes.emplace_back(
      Cause{.name = "inertia ignored",
            .factor = none,
            .words = "it is at rest at every time, in the equilibrium of the scene"},
      rms_from(recorded, [&](double, double s) { return reference.at_rest.at(0, s); }));
  return causes;
}

std::vector<std::pair<Cause, double>> fitted_causes(const MotionReference& reference,
                                                    const MarkerMotion& recorded) {
  std::vector<std::pair<Cause, double>> causes;
  const ModelMotion& model = reference.motion;
  if (const auto lag =
          best_lag(recorded, model, -std::numeric_limits<double>::infinity(), Displacement::none)) {
    causes.emplace_back(Cause{.name = "late or early",
                              .factor = lag->lag / reference.until,
                              .words = fmt::format("it is {:.3g} ms {}", std::abs(lag->lag) * 1e3,
                                                   lag->lag > 0 ? "late" : "early")},
                        lag->rms_m);
  }
  const Fitted faster = best_of(recorded, 1 / beyond, beyond, [&](double factor) -> RodAt {
    return [&, factor](double time, double s) { return model.at(factor * time, s); };
  });
  causes.emplace_back(Cause{.name = "frequency wrong",
                            .factor = faster.value,
                            .words = fmt::format("all goes {:.4g} times as fast", faster.value)},
                      faster.left);
  constexpr double most = 10;  // e-foldings over the whole time
  const Fitted damped = best_of(recorded, 0, most / reference.until, [&](double rate) -> RodAt {
    return [&, rate](double time, double s) -> Eigen::Vector3d {
      const Eigen::Vector3d rest = reference.at_rest.at(0, s);
      return rest + std::exp(-rate * time) * (model.at(time, s) - rest);
    };
  });
  const double stays = std::exp(-damped.value * reference.until);
  causes.emplace_back(Cause{.name = "damped",
                            .factor = stays,
                            .words = fmt::format("{:.3g} % of the motion is left at the end, and "
                                                 "nothing damps the rod",
                                                 stays * 100)},
                      damped.left);
  return causes;
}

}  // namespace

MotionReference motion_reference(const BatteryScene& scene, const SolveOptions& options) {
  const BatteryMotion& asked = scene.motion.value();
  const double length = scene.scene.length;
  const std::vector<double> s = equal_arc_lengths(length, points_along);
  const double end = beyond * asked.until;
  const int count = static_cast<int>(std::ceil(beyond * frames_per_asked * (asked.frames - 1))) + 1;
  ReleasedMotion moved =
      release_rod({scene.scene, asked.begin}, equal_arc_lengths(end, count), s, terms, options);
  constexpr std::size_t fewest_frames = 4;
  const std::vector<Eigen::Matrix3Xd> at_rest(
      fewest_frames, solve_reference(scene.scene, Model::energy, options).sample(s).points);
  MotionReference reference{.motion = ModelMotion(0, end, length, std::move(moved.frames)),
                            .length = length,
                            .until = asked.until,
                            .frames = asked.frames,
                            .at_rest = ModelMotion(0, end, length, at_rest)};
  double squares = 0;
  for (const double time : asked.times()) {
    for (const double at : s) {
      squares += (reference.motion.at(time, at) - reference.motion.at(0, at)).squaredNorm();
    }
  }
  reference.travel = std::sqrt(squares / static_cast<double>(s.size()) / asked.frames);
  return reference;
}

double motion_error(const MotionReference& reference, const MarkerMotion& recorded) {
  const double interval = reference.until / (reference.frames - 1);
  int times = 0;
  double before = -std::numeric_limits<double>::infinity();
  constexpr double rounding = 1e-6;
  for (const MarkerPosition& at : recorded.positions) {
    if (!on_rod(at.arc_length, reference.length)) {
      throw InputError(fmt::format("a point at s = {:g} m (allowed: 0 to the rod's {:g} m)",
                                   at.arc_length, reference.length));
    }
    if (!(at.time >= -rounding * interval && at.time <= reference.until + rounding * interval)) {
      throw InputError(
          fmt::format("a frame at {:g} s (allowed: 0 to {:g} s)", at.time, reference.until));
    }
    times += at.time > before ? 1 : 0;
    before = at.time;
  }
  const double first = recorded.positions.front().time;
  if (2 * times < reference.frames || first > interval || before < reference.until - interval) {
    throw InputError(fmt::format(
        "{} frames from {:g} to {:g} s (allowed: {} or more, from 0 to {:g} s, each end within "
        "{:g} s)",
        times, first, before, (reference.frames + 1) / 2, reference.until, interval));
  }
  return rms_of(motion_residuals(recorded, reference.motion)) / reference.travel;
}

std::vector<Cause> motion_causes(const MotionReference& reference, const MarkerMotion& recorded) {
  const double error = motion_error(reference, recorded) * reference.travel;
  if (!(error > error_floor * reference.length)) return {};
  MarkerMotion few{.file = recorded.file, .positions = {}};
  constexpr std::size_t enough = 1000;
  const std::size_t stride = 1 + recorded.positions.size() / enough;
  for (std::size_t i = 0; i < recorded.positions.size(); i += stride) {
    few.positions.push_back(recorded.positions[i]);
  }
  for (const auto& [may_leave, search] :
       {std::pair(may_leave_plain, &plain_causes), std::pair(may_leave_fitted, &fitted_causes)}) {
    std::vector<std::pair<Cause, double>> causes = search(reference, few);
    const auto best =
        std::ranges::min_element(causes, {}, [](const auto& one) { return one.second; });
    if (best->second <= may_leave * error) return {std::move(best->first)};
  }
  return {};
}

}  // namespace dlo::compare
