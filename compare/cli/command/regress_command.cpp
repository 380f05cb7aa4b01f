#include <memory>

#include "batch/baseline.hpp"
#include "batch/regression.hpp"
#include "command/commands.hpp"
#include "dlo/compare/solution.hpp"
#include "format/json.hpp"
#include "option/exit_status.hpp"
#include "option/option_values.hpp"
#include "option/output.hpp"
#include "option/scene_options.hpp"
#include "option/share.hpp"
#include "option/terminal.hpp"
#include "series/study_output.hpp"

namespace dlo::cli {
namespace {

struct RegressOptions {
  std::vector<std::string> scenes;
  std::vector<std::string> programs;
  std::string baseline;
  std::string junit;
  std::string model = "force";
  bool update = false;
  std::string growth;  // value of --tolerance
  compare::RegressionTolerance tolerance;
  SceneOptions overrides;
  OutputOptions output;
};

void run(RegressOptions options) {
  if (!options.growth.empty()) set_growth("--tolerance", options.growth, options.tolerance);
  // An unreadable baseline is reported before minutes of solving.
  const std::vector<compare::BaselineCase> baseline =
      options.update ? compare::present_baseline(options.baseline)
                     : compare::load_baseline(options.baseline);
  const compare::RegressRequest request{
      .model = compare::from_name<compare::Model>(options.model),
      .programs = compare::parse_foreign_programs(options.programs),
      .tolerance = options.tolerance,
      .solve = options.overrides.solve()};
  std::vector<compare::Scene> scenes;
  for (const std::string& path : options.scenes) {
    warn_of_polygons(scenes.emplace_back(options.overrides.load(path)));
  }
  const compare::Regression found = with_progress("regress", [&](const auto& progress) {
    return compare::regress(scenes, baseline, request, progress);
  });
  const bool solved = found.solved();
  const bool good = options.update ? solved : found.passes();
  const bool updated = options.update && solved;
  if (!options.junit.empty()) {
    write_output({.file = options.junit}, compare::junit_xml(found.results));
  }
  if (updated) compare::replace_baseline(options.baseline, baseline, found.cases);
  write_output(options.output,
               {.text =
                    [&] {
                      return updated ? baseline_update_text(found.results)
                                     : regression_text(found.results, options.output.file);
                    },
                .json = [&] { return json_text(regression_json(found.results, good)); },
                .csv = [&] { return regression_csv(found.results); }});
  if (options.update) {
    say("{} {}", options.baseline, solved ? "written" : "left as it was");
  }
  if (!solved) end_with(ExitStatus::not_converged);
  if (!good) end_with(ExitStatus::outside_tolerance);
}

}  // namespace

void add_regress(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("regress", "shape errors against a baseline under version control");
  const auto options = std::make_shared<RegressOptions>();
  command->add_option("SCENE", options->scenes, "scene files (TOML)")->required();
  add_file(*command, "--baseline", options->baseline, "the baseline (TOML)")->required();
  command->add_flag("--update", options->update,
                    "write the baseline anew, of these scenes and no others");
  add_file(*command, "--junit", options->junit, "write the verdicts as JUnit XML too");
  add_checked(*command, "--model", options->model, CLI::IsMember({"force", "chain"}),
              "force or chain");
  add_growth_options(*command, options->tolerance);
  command
      ->add_option("--tolerance", options->growth,
                   "in place of --absolute: a share of the length such as 1%, or \"5% of "
                   "deflection\" (of a stiff rod, by its weight and loads)")
      ->excludes("--absolute");
  add_program_options(*command, options->programs);
  options->overrides.add_to(*command);
  add_output_options(*command, options->output);
  command->footer(
      "Example:\n"
      "  dlo regress --baseline shapes.toml data/scenes/spring_steel_175.toml --update\n"
      "  dlo regress --baseline shapes.toml data/scenes/spring_steel_175.toml --junit dlo.xml");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
