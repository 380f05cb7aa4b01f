#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <system_error>

#include "commands.hpp"
#include "comparison_text.hpp"
#include "dlo/compare/display.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/regression.hpp"
#include "json.hpp"
#include "output.hpp"
#include "scene_options.hpp"
#include "share.hpp"
#include "terminal.hpp"

namespace dlo::cli {
namespace {

using compare::MeasuredCase;
using compare::RegressionResult;
using compare::RegressionVerdict;

struct RegressOptions {
  std::vector<std::string> scenes;
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
  const compare::Model model = compare::model_from(options.model);
  try {
    return {compare::measure_case(scene, model, options.overrides.solve()), ""};
  } catch (const compare::ConvergenceError& error) {
    return {compare::case_of(scene, model), error.what()};
  }
}

long count(const std::vector<RegressionResult>& results, RegressionVerdict verdict) {
  return std::count_if(results.begin(), results.end(),
                       [verdict](const auto& result) { return result.verdict == verdict; });
}

/// What --update did to each case of the baseline.
std::string update_text(const std::vector<RegressionResult>& results) {
  std::string out;
  for (const RegressionResult& result : results) {
    const char* done = "same";
    if (!result.expected) {
      done = "added";
    } else if (!result.measured) {
      done = "removed";
    } else if (result.verdict != RegressionVerdict::same) {
      done = "changed";
    }
    append(out, "{:<20} {}\n", done, compare::display(result.name));
    // Of a case that is new or gone the message says what to do, which has been done.
    if (result.expected && result.measured)
      append(out, "{:<20} {}\n", "", compare::display(result.message));
  }
  return out;
}

std::string text(const std::vector<RegressionResult>& results, const std::string& file) {
  std::string out;
  for (const RegressionResult& result : results) {
    const std::string verdict = fmt::format("{:<20}", compare::to_string(result.verdict));
    append(out, "{} {}\n{:<20} {}\n", verdict_word(verdict, !compare::failed(result.verdict), file),
           compare::display(result.name), "", compare::display(result.message));
  }
  const char* separator = "";
  for (const RegressionVerdict verdict :
       {RegressionVerdict::worse, RegressionVerdict::changed, RegressionVerdict::not_in_baseline,
        RegressionVerdict::not_measured, RegressionVerdict::not_solved, RegressionVerdict::better,
        RegressionVerdict::same}) {
    const long number = count(results, verdict);
    if (number == 0) continue;
    append(out, "{}{} {}", separator, number, compare::to_string(verdict));
    separator = ", ";
  }
  return out + "\n";
}

Json errors_json(const std::optional<compare::ShapeErrors>& errors) {
  if (!errors) return nullptr;
  Json result = {{"rms_over_length", errors->rms}, {"max_over_length", errors->max}};
  result["tip_over_length"] = errors->tip ? Json(*errors->tip) : Json(nullptr);
  return result;
}

Json json(const std::vector<RegressionResult>& results, bool good) {
  Json cases = Json::array();
  for (const RegressionResult& result : results) {
    cases.push_back({{"case", result.name},
                     {"verdict", compare::to_string(result.verdict)},
                     {"baseline", errors_json(result.expected)},
                     {"measured", errors_json(result.measured)},
                     {"message", result.message}});
  }
  return {{"schema", "dlo/regress/1"},
          {"verdict", good ? "pass" : "fail"},
          {"cases", std::move(cases)}};
}

std::string csv(const std::vector<RegressionResult>& results) {
  std::string out =
      "case,verdict,baseline_rms_over_length,baseline_max_over_length,baseline_tip_over_length,"
      "rms_over_length,max_over_length,tip_over_length\n";
  const auto add = [&](const std::optional<compare::ShapeErrors>& errors) {
    if (!errors) {
      out += ",,,";
      return;
    }
    append_csv(out, ",{},{},{}", compare::csv_number(errors->rms), compare::csv_number(errors->max),
               errors->tip ? compare::csv_number(*errors->tip) : "");
  };
  for (const RegressionResult& result : results) {
    append_csv(out, "{},{}", csv_field(result.name), compare::to_string(result.verdict));
    add(result.expected);
    add(result.measured);
    out += "\n";
  }
  return out;
}

void print(const RegressOptions& options, const std::vector<RegressionResult>& results, bool good,
           bool updated) {
  switch (options.output.kind()) {
    case Format::json:
      return write_output(options.output, json_text(json(results, good)));
    case Format::csv:
      return write_output(options.output, csv(results));
    case Format::text:
      return write_output(options.output,
                          updated ? update_text(results) : text(results, options.output.file));
  }
}

void run(const RegressOptions& options) {
  // An unreadable baseline is told before minutes of solving.
  std::vector<compare::BaselineCase> baseline;
  std::error_code unknown;  // writing tells what is wrong with a name
  if (!options.update || std::filesystem::exists(options.baseline, unknown)) {
    baseline = compare::load_baseline(options.baseline);
  }
  std::vector<MeasuredCase> measured;
  measured.reserve(options.scenes.size());
  {
    ProgressBar bar("regress");
    for (const std::string& path : options.scenes) {
      measured.push_back(measure(options, path));
      bar.show(static_cast<std::int64_t>(measured.size()),
               static_cast<std::int64_t>(options.scenes.size()));
    }
  }
  const std::vector<RegressionResult> results =
      compare::judge_regression(baseline, measured, options.tolerance);
  const bool solved = count(results, RegressionVerdict::not_solved) == 0;
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
    write_output({.file = options.baseline}, compare::baseline_text(cases));
  }
  print(options, results, good, options.update && solved);
  if (options.update) {
    say("{} {}", options.baseline, solved ? "written" : "left as it was");
  }
  if (!solved) throw CLI::RuntimeError(3);
  if (!good) throw CLI::RuntimeError(1);
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
  options->overrides.add_to(*command);
  add_output_options(*command, options->output);
  command->footer(
      "Example:\n"
      "  dlo regress --baseline shapes.toml data/scenes/spring_steel_175.toml --update\n"
      "  dlo regress --baseline shapes.toml data/scenes/spring_steel_175.toml --junit dlo.xml");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
