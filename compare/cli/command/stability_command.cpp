#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/scene_file.hpp"
#include "option/exit_status.hpp"
#include "option/option_values.hpp"
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
  std::vector<std::string> steppers;
  compare::StabilityOptions cases;
  compare::StabilityMapOptions grid;
  int threads = 0;
  OutputOptions output;
  PlotOptions plot;
};

/// Whether a result is a failure of the command: `auto` and `implicit` must not fail, other
/// steppers may. A case that is refused is no failure.
bool fails(const StabilityResult& result) {
  const bool may_not =
      result.stepper == compare::Stepper::automatic || result.stepper == compare::Stepper::implicit;
  return may_not && result.outcome != Outcome::pass && result.outcome != Outcome::refused;
}

void run_map(StabilityOptions& options) {
  options.plot.require_drawable();
  options.grid.axis = options.map == "cF-cc" ? compare::MapAxis::c_c : compare::MapAxis::c_h;
  options.grid.threads = options.threads;
  const compare::Scene scene =
      options.scene.empty() ? compare::hard_case_scene() : compare::load_scene(options.scene);
  warn_of_polygons(scene);
  warn_of_no_twist(scene, "the map");
  const compare::StabilityMap map = with_progress("map", [&](const auto& progress) {
    options.grid.progress = progress;
    return compare::stability_map(scene, options.grid);
  });
  write_output(options.output, stability_map_document(map), [&] { return stability_map_csv(map); });
  options.plot.draw([&] { return compare::Picture{{{{compare::map_figure(map)}}}}; });
}

void run_cases(StabilityOptions& options) {
  if (!options.steppers.empty()) {
    options.cases.steppers.clear();
    for (const std::string& name : options.steppers) {
      options.cases.steppers.push_back(compare::from_name<compare::Stepper>(name));
    }
  }
  options.cases.threads = options.threads;
  const auto results = with_progress("hard cases", [&](const auto& progress) {
    options.cases.progress = progress;
    return compare::stability(options.cases);
  });
  write_output(options.output, hard_cases_document(results));
  if (std::any_of(results.begin(), results.end(), fails)) {
    end_with(ExitStatus::outside_tolerance);
  }
}

constexpr long most_steps = 1000000000000;

void add_case_options(CLI::App& command, StabilityOptions& options) {
  const OptionGroup group(command, "Hard cases");
  command.add_option("--case", options.cases.name_contains, "only cases whose name contains this");
  command.add_option("--stepper", options.steppers, "only these steppers")
      ->check(CLI::IsMember(compare::names<compare::Stepper>()));
  const auto add_steps = [&](const char* name, long& value, const char* words) {
    add_checked(command, name, value, CLI::Range(1L, most_steps), words);
  };
  add_steps("--max-steps", options.cases.max_steps, "of the paper's steppers and verlet");
  add_steps("--max-steps-auto", options.cases.max_steps_auto, "of steppers auto and implicit");
  add_steps("--steps-at-rest", options.cases.steps_at_rest,
            "of the case at rest; implicit: a hundredth");
}

void add_map_options(CLI::App& command, StabilityOptions& options) {
  const OptionGroup group(command, "Map");
  add_checked(command, "--columns", options.grid.columns, CLI::Range(1, 1000),
              "values of c_c or c_h");
  add_checked(command, "--rows", options.grid.rows, CLI::Range(2, 1000), "values of c_F");
  add_checked(command, "--map-steps", options.grid.steps, CLI::Range(1L, most_steps),
              "of each rod");
}

}  // namespace

void add_stability(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "stability", "where the force model's steppers break: hard cases, or a map of c_F");
  const auto options = std::make_shared<StabilityOptions>();
  command->add_option("SCENE", options->scene,
                      "scene file (TOML) of a map; without it the hard cases' rod");
  CLI::Option* map_option =
      command
          ->add_option("--map", options->map,
                       "cF-cc or cF-ch: where steps stop being stable, predicted and measured")
          ->check(CLI::IsMember({"cF-cc", "cF-ch"}));
  add_checked(*command, "--threads", options->threads, CLI::Range(0, 1024),
              "at most; 0: as many as the machine has");
  add_case_options(*command, *options);
  add_map_options(*command, *options);
  add_output_options(*command, options->output);
  options->plot.add_to(*command, "the map")->needs(map_option)->group("Map");
  command->footer(
      "Exit status 1: stepper auto or implicit does not pass a case.\n"
      "Examples:\n  dlo stability --case folded\n  dlo stability --map cF-cc --columns 8 --plot "
      "map.svg");
  command->callback([options] { options->map.empty() ? run_cases(*options) : run_map(*options); });
}

}  // namespace dlo::cli
