#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "base/output_file.hpp"
#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "format/json.hpp"
#include "option/exit_status.hpp"
#include "option/option_values.hpp"
#include "option/output.hpp"
#include "option/plot.hpp"
#include "option/scene_options.hpp"
#include "option/share.hpp"
#include "option/terminal.hpp"
#include "score/card_output.hpp"
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
  say("{} answers in {}", scenes.size(), options.pack);
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
    baseline = options.update ? compare::present_baseline(options.baseline)
                              : compare::load_baseline(options.baseline);
  }
  const std::vector<compare::Card> cards = with_progress("suite", [&](const auto& progress) {
    compare::CardOptions card = options.card;
    card.progress = progress;
    card.version = DLO_VERSION;
    return compare::make_cards(version, scenes, simulators, card);
  });
  write_output(options.output, {.text = [&] { return cards_text(cards); },
                                .json = [&] { return json_text(compare::cards_json(cards)); }});
  if (!options.markdown.empty()) write_output({.file = options.markdown}, cards_markdown(cards));
  if (!options.junit.empty()) write_output({.file = options.junit}, cards_junit(cards));
  write_page(options.report, cards);
  const bool complete = std::ranges::all_of(cards, [](const compare::Card& card) {
    return card.total().failed == 0 && card.total().not_judged == 0;
  });
  if (options.baseline.empty()) {
    if (!complete) end_with(ExitStatus::not_converged);
    return;
  }
  const compare::Regression found = compare::judge_cards(baseline, cards, options.tolerance);
  if (options.update) {
    if (found.solved()) compare::replace_baseline(options.baseline, baseline, found.cases);
    say("{} {}", options.baseline, found.solved() ? "written" : "left as it was");
    if (!found.solved()) end_with(ExitStatus::not_converged);
    return;
  }
  const std::string changes = regression_changes_text(found.results, options.output.file);
  if (options.output.is(Format::text) && options.output.file.empty()) {
    write_standard_output("\n" + changes);
  } else {
    write_standard_error(changes);
  }
  if (!complete) end_with(ExitStatus::not_converged);
  if (!found.passes()) end_with(ExitStatus::outside_tolerance);
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

void add_suite(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("suite", "a battery of scenes with certified answers, and a score card");
  const auto options = std::make_shared<SuiteOptions>();
  command
      ->add_option(
          "--with", options->simulators,
          "a simulator to make the card of: NAME=COMMAND with {scene}, {points} and {shape}, or "
          "our own chain, force, chain_paper or force_paper (law paper); may be given again")
      ->type_name("NAME=COMMAND")
      ->allow_extra_args(false);
  command->add_option("--scenes", options->scenes, "classes, or names of scenes; none: all")
      ->type_name("CLASS,..")
      ->delimiter(',');
  add_checked(*command, "--points", options->card.points, CLI::Range(4, 10000),
              "N of the first of three runs; the others have 2N and 4N");
  add_checked(*command, "--jobs", options->card.threads, CLI::Range(0, 1024),
              "runs at a time; 0: as many as cores");
  add_checked(*command, "--time-limit", options->card.time_limit, number_between(1e-3, 1e9),
              "of each run of a simulator [s]");
  command
      ->add_option("--state", options->card.state,
                   "keep finished runs here; they are not run again")
      ->type_name("DIR");
  add_file(*command, "--baseline", options->baseline,
           "a baseline as that of regress (TOML); exit status 1 if an error is worse");
  command->add_flag("--update", options->update,
                    "write the errors of these scenes and simulators into the baseline");
  add_growth_options(*command, options->tolerance);
  add_file(*command, "--markdown", options->markdown, "write the cards as Markdown too");
  add_file(*command, "--junit", options->junit, "and as JUnit XML");
  add_file(*command, "--report", options->report,
           "and as a page, FILE.html: verdict, causes, picture and numbers");
  command
      ->add_option("--write", options->pack,
                   "write the answers as a pack: JSON with a schema, and points as CSV and VTU")
      ->type_name("DIR");
  add_file(*command, "--battery", options->battery,
           "a battery of your own (TOML), as data/suite/suite.toml is");
  add_output_options(*command, options->output, {"text", "json"});
  command->footer(
      "Examples:\n"
      "  dlo suite --with chain --with force --scenes weight,ends --report card.html\n"
      "  dlo suite --with mine='python3 mine.py {scene} {points} {shape}' --state runs --scenes "
      "floor\n"
      "  dlo suite --write answers --scenes floor");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
