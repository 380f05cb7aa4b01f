#include <algorithm>
#include <memory>
#include <utility>

#include "batch/baseline.hpp"
#include "batch/regression.hpp"
#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/solution.hpp"
#include "format/json.hpp"
#include "format/regression.hpp"
#include "option/exit_status.hpp"
#include "option/output.hpp"
#include "option/program_options.hpp"
#include "option/scene_options.hpp"
#include "option/share.hpp"
#include "option/terminal.hpp"

namespace dlo::cli {
namespace {

using compare::MeasuredCase;
using compare::RegressionResult;
using compare::RegressionVerdict;

struct RegressOptions {
  std::vector<std::string> scenes;
  std::vector<std::string> programs;
  std::string baseline;
  std::string junit;
  std::string model = "force";
  bool update = false;
  compare::RegressionTolerance tolerance;
  SceneOptions overrides;
  OutputOptions output;
};

MeasuredCase measure(const RegressOptions& options, const std::string& path) {
  const compare::Scene scene = options.overrides.load(path);
  warn_of_polygons(scene);
  const auto model = compare::from_name<compare::Model>(options.model);
  try {
    return {compare::measure_case(scene, model, options.overrides.solve()), ""};
  } catch (const compare::ConvergenceError& error) {
    return {compare::case_of(scene, model), error.what()};
  }
}

MeasuredCase measure_program(const RegressOptions& options, const std::string& path,
                             const compare::ForeignProgram& program) {
  const compare::Scene scene = options.overrides.load(path);
  try {
    return compare::measure_program(scene, program, options.overrides.solve());
  } catch (const compare::ConvergenceError& error) {
    compare::BaselineCase entry = compare::case_of(scene, compare::Model::force);
    entry.program = program.name;
    return {std::move(entry), error.what()};
  }
}

std::vector<MeasuredCase> measure_all(const RegressOptions& options) {
  const std::vector<compare::ForeignProgram> programs =
      compare::parse_foreign_programs(options.programs);
  std::vector<MeasuredCase> measured;
  const std::size_t all = options.scenes.size() * (1 + programs.size());
  measured.reserve(all);
  ProgressBar bar("regress");
  const auto take = [&](MeasuredCase entry) {
    measured.push_back(std::move(entry));
    bar.show(static_cast<std::int64_t>(measured.size()), static_cast<std::int64_t>(all));
  };
  for (const std::string& path : options.scenes) {
    take(measure(options, path));
    for (const compare::ForeignProgram& program : programs) {
      take(measure_program(options, path, program));
    }
  }
  return measured;
}

void run(const RegressOptions& options) {
  // An unreadable baseline is told before minutes of solving.
  const std::vector<compare::BaselineCase> baseline =
      options.update ? compare::present_baseline(options.baseline)
                     : compare::load_baseline(options.baseline);
  const std::vector<MeasuredCase> measured = measure_all(options);
  const std::vector<RegressionResult> results =
      compare::judge_regression(baseline, measured, options.tolerance);
  const bool solved = std::none_of(results.begin(), results.end(), [](const auto& result) {
    return result.verdict == RegressionVerdict::not_solved;
  });
  const bool good = options.update
                        ? solved
                        : std::none_of(results.begin(), results.end(), [](const auto& result) {
                            return compare::failed(result.verdict);
                          });
  if (!options.junit.empty()) {
    write_output({.file = options.junit}, compare::junit_xml(results));
  }
  if (options.update && solved) {
    std::vector<compare::BaselineCase> cases;
    cases.reserve(measured.size());
    for (const MeasuredCase& entry : measured) cases.push_back(entry.entry);
    compare::replace_baseline(options.baseline, baseline, cases);
  }
  const bool updated = options.update && solved;
  write_output(options.output, {.text =
                                    [&] {
                                      return updated
                                                 ? baseline_update_text(results)
                                                 : regression_text(results, options.output.file);
                                    },
                                .json = [&] { return json_text(regression_json(results, good)); },
                                .csv = [&] { return regression_csv(results); }});
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
  command->add_option("--baseline", options->baseline, "the baseline (TOML)")
      ->type_name("FILE")
      ->required();
  command->add_flag("--update", options->update,
                    "write the baseline anew, of these scenes and no others");
  command->add_option("--junit", options->junit, "write the verdicts as JUnit XML too")
      ->type_name("FILE");
  command->add_option("--model", options->model, "force or chain")
      ->check(CLI::IsMember({"force", "chain"}))
      ->capture_default_str();
  command
      ->add_option("--relative", options->tolerance.relative,
                   "how much an error may change, as a share of it such as 1%")
      ->transform(share_up_to(1e3))
      ->capture_default_str();
  command
      ->add_option("--absolute", options->tolerance.absolute,
                   "and how much beside that, as a share of the rod's length")
      ->transform(share_up_to(1e3))
      ->capture_default_str();
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
