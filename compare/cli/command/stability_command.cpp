#include <algorithm>
#include <memory>

#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/scene_file.hpp"
#include "option/command_line.hpp"
#include "option/output.hpp"
#include "option/plot.hpp"
#include "option/scene_options.hpp"
#include "option/terminal.hpp"
#include "picture/figures.hpp"
#include "series/study_output.hpp"
#include "study/hard_case.hpp"
#include "study/stability.hpp"
#include "study/stability_map.hpp"

namespace dlo::cli {
namespace {

using compare::Outcome;
using compare::StabilityResult;

struct StabilityOptions {
  std::string scene;
  std::string map;
  compare::StabilityOptions cases;
  compare::StabilityMapOptions grid;
  int threads = 0;
  OutputOptions output;
  PlotOptions plot;
};

/// Whether a result is a failure of the command: `auto` and `implicit` must not fail, other
/// steppers may. A case that is refused is no failure.
bool is_failure(const StabilityResult& result) {
  const bool may_not =
      result.stepper == compare::Stepper::automatic || result.stepper == compare::Stepper::implicit;
  return may_not && result.outcome != Outcome::pass && result.outcome != Outcome::refused;
}

void run_map(StabilityOptions options) {
  options.plot.require_drawable();
  options.grid.axis = options.map == "cF-cc" ? compare::MapAxis::c_c : compare::MapAxis::c_h;
  options.grid.threads = options.threads;
  const compare::Scene scene =
      options.scene.empty() ? compare::hard_case_scene() : compare::load_scene(options.scene);
  warn_of_neglected_by_polygon(scene);
  warn_of_no_twist(scene, "the map");
  const compare::StabilityMap map = with_progress("map", [&](const auto& progress) {
    options.grid.progress = progress;
    return compare::stability_map(scene, options.grid);
  });
  write_output(options.output, stability_map_document(map),
               {{"csv", [&] { return stability_map_csv(map); }}});
  options.plot.draw([&] { return compare::Picture{{{{compare::map_figure(map)}}}}; });
}

void run_cases(StabilityOptions options) {
  options.cases.threads = options.threads;
  const auto results = with_progress("hard cases", [&](const auto& progress) {
    options.cases.progress = progress;
    return compare::stability(options.cases);
  });
  write_output(options.output, hard_cases_document(results));
  if (std::any_of(results.begin(), results.end(), is_failure)) {
    exit_with_status(ExitStatus::outside_tolerance);
  }
}

}  // namespace

void add_stability_command(CLI::App& app) {
  add_command<StabilityOptions>(
      app, "stability",
      [](const StabilityOptions& options) {
        options.map.empty() ? run_cases(options) : run_map(options);
      },
      [](Command& command, StabilityOptions& o) {
        command.bind("SCENE", o.scene, "--map", o.map, "--threads", o.threads, "--case",
                     o.cases.name_contains, "--stepper", o.cases.steppers, "--max-steps",
                     o.cases.max_steps, "--max-steps-auto", o.cases.max_steps_auto,
                     "--steps-at-rest", o.cases.steps_at_rest, "--columns", o.grid.columns,
                     "--rows", o.grid.rows, "--map-steps", o.grid.steps, o.output, o.plot);
      });
}

}  // namespace dlo::cli
