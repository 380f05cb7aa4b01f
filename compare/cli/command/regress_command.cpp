#include <memory>

#include "batch/baseline.hpp"
#include "batch/regression.hpp"
#include "command/commands.hpp"
#include "dlo/compare/solution.hpp"
#include "format/json.hpp"
#include "option/command_line.hpp"
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
  compare::Model model = compare::Model::force;
  bool update = false;
  std::string growth;  // value of --tolerance
  compare::RegressionTolerance tolerance;
  SceneOptions overrides;
  OutputOptions output;
};

void run(const RegressOptions& given) {
  RegressOptions options = given;
  if (!options.growth.empty()) set_growth("--tolerance", options.growth, options.tolerance);
  // An unreadable baseline is reported before minutes of solving.
  const std::vector<compare::BaselineCase> baseline =
      options.update ? compare::load_baseline_if_exists(options.baseline)
                     : compare::load_baseline(options.baseline);
  const compare::RegressRequest request{
      .model = options.model,
      .programs = compare::parse_foreign_programs(options.programs),
      .tolerance = options.tolerance,
      .solve = options.overrides.solve()};
  std::vector<compare::Scene> scenes;
  for (const std::string& path : options.scenes) {
    warn_of_neglected_by_polygon(scenes.emplace_back(options.overrides.load(path)));
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
               Formats{{"text",
                        [&] {
                          return updated ? baseline_update_text(found.results)
                                         : regression_text(found.results, options.output.file);
                        }},
                       {"json", [&] { return json_text(regression_json(found.results, good)); }},
                       {"csv", [&] { return regression_csv(found.results); }}});
  if (options.update) {
    print_message("{} {}", options.baseline, solved ? "written" : "left as it was");
  }
  if (!solved) exit_with_status(ExitStatus::not_converged);
  if (!good) exit_with_status(ExitStatus::outside_tolerance);
}

}  // namespace

void add_regress_command(CLI::App& app) {
  add_command<RegressOptions>(app, "regress", run, [](Command& command, RegressOptions& o) {
    command.bind("SCENE", o.scenes, "--baseline", o.baseline, "--update", o.update, "--junit",
                 o.junit, "--model", o.model, "--relative", o.tolerance.relative, "--absolute",
                 o.tolerance.absolute, "--tolerance", o.growth, "--with", o.programs, o.overrides,
                 o.output);
  });
}

}  // namespace dlo::cli
