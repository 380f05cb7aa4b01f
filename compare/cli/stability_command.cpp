#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

#include "commands.hpp"
#include "comparison_text.hpp"
#include "dlo/compare/csv.hpp"
#include "dlo/compare/display.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/hard_case.hpp"
#include "dlo/compare/stability.hpp"
#include "dlo/compare/stability_map.hpp"
#include "json.hpp"
#include "output.hpp"
#include "scene_options.hpp"
#include "terminal.hpp"

namespace dlo::cli {
namespace {

using compare::MapColumn;
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
};

/// 3 significant digits at most: 812, 20k, 1.5M.
std::string short_count(long count) {
  const auto value = static_cast<double>(count);
  if (count < 1000) return fmt::format("{}", count);
  if (count < 1'000'000) return fmt::format("{:.3g}k", value / 1e3);
  return fmt::format("{:.3g}M", value / 1e6);
}

std::string error_text(const StabilityResult& result) {
  if (result.outcome == Outcome::refused) return "";
  if (!std::isfinite(result.error_over_length)) return "inf";
  return fmt::format("{:.0e}", result.error_over_length);
}

bool creeping(const StabilityResult& result) {
  return result.outcome == Outcome::wrong && !result.at_rest;
}

std::string outcome_text(const StabilityResult& result) {
  return creeping(result) ? "creeping" : compare::to_string(result.outcome);
}

std::string table_head(const std::vector<StabilityResult>& results, std::size_t steppers,
                       int width) {
  std::string out = fmt::format("{:<28}", "");
  for (std::size_t k = 0; k < steppers; ++k) {
    append(out, "{:<{}}", compare::to_string(results[k].stepper), width);
  }
  while (out.back() == ' ') out.pop_back();
  return out + "\n";
}

std::string cases_text(const std::vector<StabilityResult>& results, std::size_t steppers) {
  constexpr int outcome_width = 19;
  constexpr int steps_width = 10;
  std::string outcomes =
      "Outcome, and largest distance from the chain's rest shape over the "
      "length\n" +
      table_head(results, steppers, outcome_width);
  std::string steps = "\nSteps\n" + table_head(results, steppers, steps_width);
  std::string notes = "\nNotes\n";
  for (std::size_t i = 0; i < results.size(); ++i) {
    const StabilityResult& result = results[i];
    if (i % steppers == 0) {
      append(outcomes, "{:<28}", result.name);
      append(steps, "{:<28}", result.name);
      append(notes, "  {}: {}\n", result.name, result.what);
    }
    const bool last = i % steppers + 1 == steppers;
    const std::string error = error_text(result);
    const std::string cell =
        error.empty() ? outcome_text(result) : fmt::format("{:<11}{}", outcome_text(result), error);
    append(outcomes, "{:<{}}{}", cell, last ? 0 : outcome_width, last ? "\n" : "");
    append(steps, "{:<{}}{}", short_count(result.steps), last ? 0 : steps_width, last ? "\n" : "");
    // A refusal is the case's, not the stepper's.
    const bool repeated = result.outcome == Outcome::refused && i % steppers > 0;
    if (result.note.empty() || creeping(result) || repeated) continue;
    append(notes, "    {}: {}\n",
           result.outcome == Outcome::refused ? "all" : compare::to_string(result.stepper),
           result.note);
  }
  return outcomes + steps + notes;
}

std::string cases_csv(const std::vector<StabilityResult>& results) {
  std::string text = "case,stepper,outcome,steps,error_over_length,at_rest,note\n";
  for (const StabilityResult& r : results) {
    append(text, "{},{},{},{},{},{},{}\n", csv_field(r.name), compare::to_string(r.stepper),
           compare::to_string(r.outcome), r.steps, compare::csv_number(r.error_over_length),
           r.at_rest, csv_field(r.note));
  }
  return text;
}

Json cases_json(const std::vector<StabilityResult>& results) {
  Json cases = Json::array();
  for (const StabilityResult& r : results) {
    cases.push_back({{"case", r.name},
                     {"what", r.what},
                     {"stepper", compare::to_string(r.stepper)},
                     {"outcome", compare::to_string(r.outcome)},
                     {"steps", r.steps},
                     {"error_over_length", r.error_over_length},
                     {"at_rest", r.at_rest},
                     {"note", r.note}});
  }
  return {{"schema", "dlo/stability/1"}, {"cases", std::move(cases)}};
}

std::string map_text(const compare::StabilityMap& map) {
  std::string out;
  append(out, "{}: largest c_F of steps without limit or damping, from rest\n",
         compare::display(map.scene));
  append(out, "{:>12} {:>8} {:>15} {:>16} {:>16} {:>9} {:>17}\n", "c_c [N]", "c_h", "mode [N/m]",
         "predicted [m/N]", "measured [m/N]", "ratio", "Table 1 / limit");
  double least = INFINITY;
  double most = 0;
  for (const MapColumn& c : map.columns) {
    const double ratio = c.measured / c.predicted;
    least = std::min(least, ratio);
    most = std::max(most, ratio);
    append(out, "{:12.5g} {:8.4f} {:15.5g} {:16.5g} {:16.5g} {:9.4f} {:17.3f}\n", c.c_c, c.c_h,
           c.fastest_mode, c.predicted, c.measured, ratio, c.table_1 / c.measured);
  }
  append(out,
         "\nmeasured / predicted: {:.4f} to {:.4f}; the prediction is safe where this is >= 1.\n"
         "Table 1 is the paper's proportion c_F = 0.86 L/(2 c_c); above 1 it blows up.\n",
         least, most);
  return out;
}

const char* state(Outcome outcome) {
  return outcome == Outcome::pass ? "stable" : compare::to_string(outcome);
}

std::string map_csv(const compare::StabilityMap& map) {
  const std::size_t rows = map.points.size() / map.columns.size();
  std::string text = "c_c,c_h,c_F,state,fastest_mode,c_F_predicted,c_F_measured\n";
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    const compare::MapPoint& p = map.points[i];
    const MapColumn& c = map.columns[i / rows];
    append(text, "{},{},{},{},{},{},{}\n", compare::csv_number(p.c_c), compare::csv_number(p.c_h),
           compare::csv_number(p.c_F), state(p.outcome), compare::csv_number(c.fastest_mode),
           compare::csv_number(c.predicted), compare::csv_number(c.measured));
  }
  return text;
}

Json map_json(const compare::StabilityMap& map) {
  Json columns = Json::array();
  for (const MapColumn& c : map.columns) {
    columns.push_back({{"c_c", c.c_c},
                       {"c_h", c.c_h},
                       {"fastest_mode_N_per_m", c.fastest_mode},
                       {"c_F_predicted", c.predicted},
                       {"c_F_measured", c.measured},
                       {"c_F_table_1", c.table_1}});
  }
  Json points = Json::array();
  for (const compare::MapPoint& p : map.points) {
    points.push_back({{"c_c", p.c_c}, {"c_h", p.c_h}, {"c_F", p.c_F}, {"state", state(p.outcome)}});
  }
  return {{"schema", "dlo/stability-map/1"},
          {"scene", map.scene},
          {"columns", std::move(columns)},
          {"points", std::move(points)}};
}

/// The paper's steppers may fail, `auto` may not.
bool auto_fails(const StabilityResult& result) {
  return result.stepper == compare::StepperName::automatic && result.outcome != Outcome::pass &&
         result.outcome != Outcome::refused;
}

void run_map(StabilityOptions& options) {
  options.grid.axis = options.map == "cF-cc" ? compare::MapAxis::c_c : compare::MapAxis::c_h;
  options.grid.threads = options.threads;
  const compare::Scene scene =
      options.scene.empty() ? compare::hard_case_scene() : compare::load_scene(options.scene);
  const compare::StabilityMap map = [&] {
    ProgressBar bar("map");
    options.grid.progress = [&](std::int64_t done, std::int64_t total) { bar.show(done, total); };
    return compare::stability_map(scene, options.grid);
  }();
  switch (options.output.kind()) {
    case Format::json:
      return write_output(options.output, json_text(map_json(map)));
    case Format::csv:
      return write_output(options.output, map_csv(map));
    case Format::text:
      return write_output(options.output, map_text(map));
  }
}

void run_cases(StabilityOptions& options) {
  if (!options.steppers.empty()) {
    options.cases.steppers.clear();
    for (const std::string& name : options.steppers) {
      options.cases.steppers.push_back(compare::stepper_from(name));
    }
  }
  options.cases.threads = options.threads;
  const std::vector<StabilityResult> results = [&] {
    ProgressBar bar("hard cases");
    options.cases.progress = [&](std::int64_t done, std::int64_t total) { bar.show(done, total); };
    return compare::stability(options.cases);
  }();
  std::string content;
  switch (options.output.kind()) {
    case Format::json:
      content = json_text(cases_json(results));
      break;
    case Format::csv:
      content = cases_csv(results);
      break;
    case Format::text:
      content = cases_text(results, options.cases.steppers.size());
      break;
  }
  write_output(options.output, content);
  if (std::any_of(results.begin(), results.end(), auto_fails)) throw CLI::RuntimeError(1);
}

}  // namespace

void add_stability(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "stability", "where the force model's steppers break: hard cases, or a map of c_F");
  const auto options = std::make_shared<StabilityOptions>();
  command->add_option("SCENE", options->scene,
                      "scene file (TOML) of a map; without it the hard cases' rod");
  command
      ->add_option("--map", options->map,
                   "cF-cc or cF-ch: where steps stop being stable, predicted and measured")
      ->check(CLI::IsMember({"cF-cc", "cF-ch"}));
  command->add_option("--threads", options->threads, "at most; 0: as many as the machine has")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  const std::string table = "Hard cases";
  command->add_option("--case", options->cases.name_contains, "only cases whose name contains this")
      ->group(table);
  command->add_option("--stepper", options->steppers, "only these steppers")
      ->check(CLI::IsMember(compare::stepper_names()))
      ->group(table);
  const auto steps = CLI::Range(1L, 1000000000000L);
  command->add_option("--max-steps", options->cases.max_steps, "of the paper's steppers")
      ->check(steps)
      ->capture_default_str()
      ->group(table);
  command->add_option("--max-steps-auto", options->cases.max_steps_auto, "of stepper auto")
      ->check(steps)
      ->capture_default_str()
      ->group(table);
  command->add_option("--steps-at-rest", options->cases.steps_at_rest, "of the case at rest")
      ->check(steps)
      ->capture_default_str()
      ->group(table);
  const std::string map = "Map";
  command->add_option("--columns", options->grid.columns, "values of c_c or c_h")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str()
      ->group(map);
  command->add_option("--rows", options->grid.rows, "values of c_F")
      ->check(CLI::Range(2, 1000))
      ->capture_default_str()
      ->group(map);
  command->add_option("--map-steps", options->grid.steps, "of each rod")
      ->check(steps)
      ->capture_default_str()
      ->group(map);
  add_output_options(*command, options->output);
  command->footer(
      "Exit status 1: stepper auto does not pass a case.\n"
      "Examples:\n  dlo stability --case folded\n  dlo stability --map cF-cc --columns 8");
  command->callback([options] {
    if (!options->map.empty()) return run_map(*options);
    if (!options->scene.empty()) {
      throw compare::InputError(fmt::format(
          "stability: SCENE = {}: only a map takes a scene (allowed with --map cF-cc or cF-ch)",
          options->scene));
    }
    run_cases(*options);
  });
}

}  // namespace dlo::cli
