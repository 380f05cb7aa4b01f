#include <fmt/format.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "base/input_file.hpp"
#include "base/text.hpp"
#include "bind_scene.hpp"
#include "format/json.hpp"
#include "long_call.hpp"
#include "module.hpp"
#include "motion/dynamic_track.hpp"
#include "option/share.hpp"
#include "picture/figures.hpp"
#include "recording/motion_check.hpp"
#include "recording/motion_fit.hpp"
#include "result.hpp"
#include "series/series_output.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::python {
namespace {

/// Returns the damping of a rod in motion: the arguments, and for None the values of `calibrated`.
compare::RodDamping damping_of(const SharedScene& shared, const py::dict& what) {
  const auto given = [&what](const char* key) { return what[key].cast<std::optional<double>>(); };
  return cli::DampingOptions{given("damping"), given("drag"), given("quadratic_drag")}.of(
      shared->calibrated);
}

/// Motion with the picture of its frames.
struct Followed : Texts {
  Followed(std::string text, std::string json, compare::Panel frames)
      : Texts(std::move(text), std::move(json)), strip(std::move(frames)) {}
  [[nodiscard]] compare::Panel panel(std::optional<bool> /*in_space*/) const override {
    return strip;
  }

  compare::Panel strip;
};

py::object track(const SharedScene& shared, const py::dict& what, const py::object& make_result,
                 const py::dict& limits) {
  using Given = std::optional<double>;
  const compare::Scene& scene = shared->scene;
  compare::TrackRequest request{
      .options = {.from = what["begin"].cast<Given>(),
                  .to = what["end"].cast<Given>(),
                  .force = what["force"].cast<bool>() ? compare::ForceModelRun::runs
                                                      : compare::ForceModelRun::absent,
                  .samples = what["samples"].cast<int>(),
                  .solve = verified_options(limits)},
      .frame_rate = what["frame_rate"].cast<Given>(),
      .obstacle_rate = what["obstacle_rate"].cast<Given>(),
      .step_rate = what["step_rate"].cast<Given>()};
  if (what["dynamic"].cast<bool>()) {
    request.damping = damping_of(shared, what);
  }
  const compare::TrackResult found = run_long([&](Signals& signals) {
    return compare::follow(scene, request, [&](auto, auto) { signals.throw_if_stopped(); });
  });
  const compare::DynamicTrack* dynamic = found.moving();
  const cli::TrackFrames all{.frame_interval = 1, .points = true};
  py::object result = make_result(AnyResult(std::make_shared<Followed>(
      cli::track_text(found, scene), cli::json_text(cli::track_document(found, scene, all).json),
      compare::track_figures(scene, {found.track, dynamic}, found.options).strip.panels.front())));
  const std::optional<compare::TrackStop>& stopped =
      dynamic != nullptr ? dynamic->stopped : found.track.stopped;
  if (stopped) {
    raise_convergence(
        fmt::format("{}: stopped at {:g} s: {}", scene.file, stopped->time, stopped->why), result);
  }
  return result;
}

/// Recorded motion: rows of time, arc length, x, y, z; or the name of a file, as bytes.
using RecordedRows = std::variant<py::bytes, std::vector<std::vector<double>>>;

compare::MarkerMotion recorded_motion(const RecordedRows& rows, const std::string& name) {
  if (const auto* file = std::get_if<py::bytes>(&rows)) {
    const std::string path(*file);
    return compare::parse_markers(compare::read_file(path), compare::valid_utf8(path));
  }
  std::string text = "time,s,x,y,z\n";
  for (const std::vector<double>& row : std::get<1>(rows)) {
    text += fmt::format("{}\n", fmt::join(row, ","));
  }
  return compare::parse_markers(text, name);
}

std::pair<AnyResult, std::string> calibrate_motion(const SharedScene& shared,
                                                   const RecordedRows& rows,
                                                   const std::string& name,
                                                   const py::dict& limits) {
  const compare::MarkerMotion recorded = recorded_motion(rows, name);
  const compare::SolveOptions solve = verified_options(limits);
  const compare::MotionFit found = run_long([&](Signals& signals) {
    return compare::fit_motion(
        shared->scene, {recorded},
        {.damping = cli::DampingOptions{}.of(shared->calibrated), .solve = solve},
        [&](const std::string&) { signals.throw_if_stopped(); });
  });
  return {std::make_shared<Texts>(cli::motion_fit_document(found, shared->scene)),
          found.not_identified.empty() ? cli::motion_toml(found, shared->scene) : ""};
}

AnyResult check_motion(const SharedScene& shared, const RecordedRows& rows, const py::dict& what,
                       const py::dict& limits) {
  const compare::Scene& scene = shared->scene;
  compare::MotionCheckRequest request{
      .model = what["dynamic"].cast<bool>() ? compare::MotionModel::with_inertia
                                            : compare::MotionModel::at_rest,
      .damping = damping_of(shared, what),
      .from = what["begin"].cast<std::optional<double>>(),
      .frame_rate = what["frame_rate"].cast<std::optional<double>>(),
      .explaining =
          what["explain"].cast<bool>() ? compare::Explaining::yes : compare::Explaining::no,
      .solve = verified_options(limits)};
  request.tolerance = cli::shape_tolerance("tolerance",
                                           {what["tolerance"].cast<std::optional<std::string>>(),
                                            what["measure"].cast<std::string>(), std::nullopt},
                                           scene.length);
  const compare::MarkerMotion recorded = recorded_motion(rows, "motion");
  const compare::MotionCheck found = run_long([&](Signals& signals) {
    return compare::check_motion(scene, recorded, request,
                                 [&](auto, auto) { signals.throw_if_stopped(); });
  });
  return std::make_shared<Texts>(cli::motion_check_document(found));
}

}  // namespace

void bind_track(py::module_& module) {
  module.def("track", &track);
  module.def("calibrate_motion", &calibrate_motion);
  module.def("check_motion", &check_motion);
}

}  // namespace dlo::python
