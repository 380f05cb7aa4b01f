#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "base/output_file.hpp"
#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "format/json.hpp"
#include "option/command_line.hpp"
#include "option/output.hpp"
#include "option/plot.hpp"
#include "option/terminal.hpp"
#include "series/study_output.hpp"
#include "suite/card.hpp"
#include "suite/pack.hpp"

namespace dlo::cli {
namespace {

struct SuiteOptions {
  std::string battery;
  std::vector<std::string> scenes;
  std::string pack;
  std::vector<std::string> simulators;
  compare::CardOptions card;
  std::string markdown;
  std::string junit;
  std::string report;
  std::string baseline;
  bool update = false;
  compare::RegressionTolerance tolerance;
  OutputOptions output;
};

void write_pack(const SuiteOptions& options, const std::string& version,
                const std::vector<compare::BatteryScene>& scenes) {
  compare::write_pack(options.pack, compare::certified_pack(version, scenes, options.card.threads));
  print_message("{} answers in {}", scenes.size(), options.pack);
}

/// Writes the page of --report.
void write_page(const std::string& file, const std::vector<compare::Card>& cards) {
  if (file.empty()) return;
  std::vector<compare::PageResult> results;
  for (const compare::Card& card : cards) {
    compare::PageResult& page = results.emplace_back(card_page(card));
    page.pictures = page_pictures({{{{card_figure(card)}}}},
                                  "card-" + std::to_string(results.size()), "--report " + file);
  }
  write_output({.file = file}, compare::page_html(results, "dlo suite", DLO_VERSION));
}

void write_cards(const SuiteOptions& options, const std::string& version,
                 const std::vector<compare::BatteryScene>& scenes) {
  const std::vector<compare::Simulator> simulators = compare::parse_simulators(options.simulators);
  // An unreadable baseline is reported before minutes of runs.
  std::vector<compare::BaselineCase> baseline;
  if (!options.baseline.empty()) {
    baseline = options.update ? compare::load_baseline_if_exists(options.baseline)
                              : compare::load_baseline(options.baseline);
  }
  const std::vector<compare::Card> cards = with_progress("suite", [&](const auto& progress) {
    compare::CardOptions card = options.card;
    card.progress = progress;
    card.version = DLO_VERSION;
    return compare::make_cards(version, scenes, simulators, card);
  });
  write_output(options.output,
               Formats{{"text", [&] { return cards_text(cards); }},
                       {"json", [&] { return json_text(compare::cards_json(cards)); }}});
  if (!options.markdown.empty()) write_output({.file = options.markdown}, cards_markdown(cards));
  if (!options.junit.empty()) write_output({.file = options.junit}, cards_junit(cards));
  write_page(options.report, cards);
  const bool complete = std::ranges::all_of(cards, [](const compare::Card& card) {
    return card.total().failed == 0 && card.total().not_judged == 0;
  });
  if (options.baseline.empty()) {
    if (!complete) exit_with_status(ExitStatus::not_converged);
    return;
  }
  const compare::Regression found = compare::judge_cards(baseline, cards, options.tolerance);
  if (options.update) {
    if (found.solved()) compare::replace_baseline(options.baseline, baseline, found.cases);
    print_message("{} {}", options.baseline, found.solved() ? "written" : "left as it was");
    if (!found.solved()) exit_with_status(ExitStatus::not_converged);
    return;
  }
  const std::string changes = regression_changes_text(found.results, options.output.file);
  if (options.output.format == "text" && options.output.file.empty()) {
    write_standard_output("\n" + changes);
  } else {
    write_standard_error(changes);
  }
  if (!complete) exit_with_status(ExitStatus::not_converged);
  if (!found.passes()) exit_with_status(ExitStatus::outside_tolerance);
}

void run(const SuiteOptions& options) {
  const compare::Battery battery =
      options.battery.empty() ? compare::builtin_battery() : compare::load_battery(options.battery);
  const std::vector<compare::BatteryScene> scenes = chosen_scenes(battery, options.scenes);
  if (options.pack.empty() && options.simulators.empty()) {
    throw compare::InputError(
        "dlo suite: nothing to do (allowed: --write FOLDER, --with NAME=COMMAND, or both)");
  }
  if (!options.pack.empty()) compare::require_own_pack(options.pack, scenes);
  if (!options.pack.empty()) write_pack(options, battery.version, scenes);
  if (!options.simulators.empty()) write_cards(options, battery.version, scenes);
}

}  // namespace

void add_suite_command(CLI::App& app) {
  add_command<SuiteOptions>(app, "suite", run, [](Command& command, SuiteOptions& o) {
    command.bind("--with", o.simulators, "--scenes", o.scenes, "--points", o.card.points, "--jobs",
                 o.card.threads, "--time-limit", o.card.time_limit, "--state", o.card.state,
                 "--baseline", o.baseline, "--update", o.update, "--relative", o.tolerance.relative,
                 "--absolute", o.tolerance.absolute, "--markdown", o.markdown, "--junit", o.junit,
                 "--report", o.report, "--write", o.pack, "--battery", o.battery, o.output);
  });
}

}  // namespace dlo::cli
