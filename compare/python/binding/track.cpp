#include "motion/track.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dlo/compare/error.hpp"
#include "errors.hpp"
#include "long_call.hpp"
#include "module.hpp"
#include "motion/dynamic_track.hpp"
#include "picture.hpp"
#include "scene.hpp"
#include "series/dynamic_track.hpp"
#include "series/track.hpp"
#include "solve_options.hpp"

namespace dlo::python {
namespace {

/// A part of the motion, None for what the scene says.
struct Part {
  std::optional<double> begin, end, frame_rate, obstacle_rate, step_rate;
};

compare::TrackOptions track_options(const compare::Scene& scene, const Part& part, bool force,
                                    int samples, const py::dict& limits) {
  compare::TrackOptions options;
  options.from = part.begin;
  options.to = part.end;
  options.rates = scene.track;
  options.rates.frames = part.frame_rate.value_or(options.rates.frames);
  options.rates.steps = part.step_rate.value_or(options.rates.steps);
  if (part.obstacle_rate) options.rates.obstacles = part.obstacle_rate;
  if (!force) options.force = compare::ForceBeside::absent;
  options.samples = samples;
  options.solve = solve_options(limits);
  options.solve.accept_unverified = false;
  constexpr double most = 1e9;
  const auto rate = [](double value) { return value > 0 && value <= most; };
  if (!rate(options.rates.frames) || !rate(options.rates.steps) ||
      !rate(options.rates.obstacles.value_or(1)) || samples < 2) {
    throw compare::InputError(
        "track: out of range (allowed: rates > 0, up to 1e9 Hz, samples >= 2)");
  }
  return options;
}

/// @param damping  of a rod with inertia, of the material and of the air; none: it is at rest
py::object track(const SharedScene& shared, const std::vector<std::optional<double>>& part,
                 bool force, const std::optional<std::pair<double, double>>& damping, int samples,
                 const py::object& make_result, const py::dict& limits) {
  const compare::Scene& scene = shared->scene;
  const compare::TrackOptions options = track_options(
      scene, {part.at(0), part.at(1), part.at(2), part.at(3), part.at(4)}, force, samples, limits);
  std::optional<compare::DynamicTrack> moving;
  const compare::Track found = run_long([&](Signals& signals) {
    if (damping) compare::require_dynamic(scene, options);
    compare::Track at_rest =
        compare::track(scene, options, [&signals](auto, auto) { signals.throw_if_stopped(); });
    if (damping) {
      moving = compare::dynamic_track(scene, at_rest, options, {damping->first, damping->second});
    }
    return at_rest;
  });
  const compare::DynamicTrack* dynamic = moving ? &*moving : nullptr;
  std::string text = cli::track_text(found, scene, options);
  if (dynamic != nullptr) text += cli::dynamic_text(*dynamic);
  py::object result = make_result(
      text, cli::track_json(found, scene, options, {.every = 1, .points = true}, dynamic));
  result.attr("_views") = view_list(compare::views_of(scene, all_points(found.frames)));
  const std::optional<compare::TrackStop>& stopped = moving ? moving->stopped : found.stopped;
  if (stopped) {
    raise_convergence(
        fmt::format("{}: stopped at {:g} s: {}", scene.file, stopped->time, stopped->why), result);
  }
  return result;
}

}  // namespace

void bind_track(py::module_& module) {
  module.def("track", &track, py::arg("scene"), py::arg("part"), py::arg("force"),
             py::arg("damping"), py::arg("samples"), py::arg("make_result"), py::arg("limits"));
}

}  // namespace dlo::python
