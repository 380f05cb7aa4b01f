#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>

#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "motion/track.hpp"
#include "option/option_values.hpp"
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
  if (command.no_force) request.options.force = compare::ForceBeside::absent;
  if (command.dynamic) request.damping = command.damping.of(command.overrides.calibrated());
  request.options.solve = command.overrides.solve();
  if (!command.no_force) warn_of_polygons(scene);
  const compare::TrackResult result = with_progress(
      "track", [&](const auto& progress) { return compare::follow(scene, request, progress); });
  const compare::Track& track = result.track;
  const compare::DynamicTrack* dynamic = result.moving();
  if (!command.paraview.empty()) {
    write_series(result, scene, command.frames, command.paraview);
  }
  write_output(
      command.output,
      {.text = [&] { return track_text(result, scene); },
       .json = [&] { return json_text(track_document(result, scene, command.frames).json); },
       .csv = [&] { return track_csv(result, scene, command.frames); }});
  command.plot.draw([&] {
    return compare::track_picture(scene, {track, dynamic}, result.options);
  });
  throw_if_stopped(scene, track.stopped, "", track.frames.size());
  if (dynamic != nullptr) {
    throw_if_stopped(scene, dynamic->stopped, " the moving rod", dynamic->frames.size());
  }
}

}  // namespace

void add_track(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "track", "follow the rod while grippers and obstacles move: forces, contacts, snaps, lag");
  const auto options = std::make_shared<TrackCommand>();
  command->add_option("SCENE", options->scene, "scene file (TOML) with poses")->required();
  const auto rate = [&](const std::string& name, std::optional<double>& value,
                        const std::string& what) {
    command->add_option(name, value, what)->check(number_between(1e-6, 1e9))->type_name("HZ");
  };
  constexpr double most = 1e12;  // [s], the limit of times in files
  command
      ->add_option("--from", options->request.options.from,
                   "first time [s], default the first pose's")
      ->check(number_between(-most, most));
  command->add_option("--to", options->request.options.to, "last time [s], default the last pose's")
      ->check(number_between(-most, most));
  rate("--frame-rate", options->request.frame_rate,
       "frames a second, default [track] frame_rate of the scene, or 1000");
  rate("--obstacle-rate", options->request.obstacle_rate,
       "how often obstacles move, default [track] obstacle_rate, or with every frame");
  rate("--step-rate", options->request.step_rate,
       "steps of the force model a second, default [track] step_rate, or 30000");
  command->add_flag("--no-force", options->no_force, "leave the force model out");
  CLI::Option* const dynamic = command->add_flag("--dynamic", options->dynamic,
                                                 "the rod with its inertia too, as its shapes at "
                                                 "rest move at first; the force model against it");
  options->damping.add_to(*command, dynamic);
  add_checked(*command, "--samples", options->request.options.samples, CLI::Range(2, 10000),
              "points of a frame's shape");
  add_checked(*command, "--every", options->frames.every, CLI::Range(1, 100000000),
              "write every so many-th frame to JSON, CSV and ParaView, and those of events");
  command->add_flag("--shapes", options->frames.points, "in JSON the frames' points too");
  add_file(*command, "--paraview", options->paraview,
           "write FILE such as rod.vtk.series for ParaView, and rod_00000.vtk, .. beside it");
  options->overrides.add_moving_to(*command);
  options->plot.add_to(*command, "shapes over time and the grippers' forces");
  add_output_options(*command, options->output);
  command->footer(
      "Exit status 3: the motion asks for what cannot be, such as grippers farther apart than\n"
      "the rod, or the rod passes through itself; what was before it is written.\n"
      "Examples:\n"
      "  dlo track data/scenes/corner_routing.toml --frame-rate 100 --no-force\n"
      "  dlo track data/scenes/buckling_wire.toml --frame-rate 50 --format csv\n"
      "  dlo track data/scenes/swung_rod.toml --frame-rate 50 --dynamic --damping 0.01");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
