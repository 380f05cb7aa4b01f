#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>

#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "motion/track.hpp"
#include "option/command_line.hpp"
#include "option/output.hpp"
#include "option/plot.hpp"
#include "option/scene_options.hpp"
#include "option/share.hpp"
#include "option/terminal.hpp"
#include "picture/figures.hpp"
#include "series/series_output.hpp"

namespace dlo::cli {
namespace {

struct TrackCommand {
  std::string scene;
  compare::TrackRequest request;
  bool no_force = false;
  bool dynamic = false;
  DampingOptions damping;
  TrackFrames frames;
  std::string paraview;
  SceneOptions overrides;
  PlotOptions plot;
  OutputOptions output;
};

void throw_if_stopped(const compare::Scene& scene, const std::optional<compare::TrackStop>& stopped,
                      const char* what, std::size_t frames) {
  if (!stopped) return;
  throw compare::ConvergenceError(
      fmt::format("{}:{} stopped at {:g} s: {} ({} frames before it are written)", scene.file, what,
                  stopped->time, stopped->why, frames));
}

void run(const TrackCommand& command) {
  command.plot.require_drawable();
  const compare::Scene scene = command.overrides.load(command.scene);
  warn_of_friction(scene);
  compare::TrackRequest request = command.request;
  if (command.no_force) request.options.force = compare::ForceModelRun::absent;
  if (command.dynamic) request.damping = command.damping.of(command.overrides.calibrated());
  request.options.solve = command.overrides.solve();
  if (!command.no_force) warn_of_neglected_by_polygon(scene);
  const compare::TrackResult result = with_progress(
      "track", [&](const auto& progress) { return compare::follow(scene, request, progress); });
  const compare::Track& track = result.track;
  const compare::DynamicTrack* dynamic = result.moving();
  if (!command.paraview.empty()) {
    write_series(result, scene, command.frames, command.paraview);
  }
  write_output(
      command.output,
      Formats{
          {"text", [&] { return track_text(result, scene); }},
          {"json", [&] { return json_text(track_document(result, scene, command.frames).json); }},
          {"csv", [&] { return track_csv(result, scene, command.frames); }}});
  command.plot.draw([&] {
    const compare::TrackFigures figures =
        compare::track_figures(scene, {track, dynamic}, result.options);
    return compare::Picture{{{{figures.strip}, {figures.forces}}}};
  });
  throw_if_stopped(scene, track.stopped, "", track.frames.size());
  if (dynamic != nullptr) {
    throw_if_stopped(scene, dynamic->stopped, " the moving rod", dynamic->frames.size());
  }
}

}  // namespace

void add_track_command(CLI::App& app) {
  add_command<TrackCommand>(app, "track", run, [](Command& command, TrackCommand& o) {
    command.bind("SCENE", o.scene, "--from", o.request.options.from, "--to", o.request.options.to,
                 "--frame-rate", o.request.frame_rate, "--obstacle-rate", o.request.obstacle_rate,
                 "--step-rate", o.request.step_rate, "--no-force", o.no_force, "--dynamic",
                 o.dynamic, o.damping, "--samples", o.request.options.samples, "--every",
                 o.frames.frame_interval, "--shapes", o.frames.points, "--paraview", o.paraview,
                 o.overrides, o.plot, o.output);
  });
}

}  // namespace dlo::cli
