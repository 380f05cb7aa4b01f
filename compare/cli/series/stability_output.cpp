#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "option/output.hpp"
#include "polygon/point_layout.hpp"
#include "record/csv_table.hpp"
#include "series/study_output.hpp"

namespace dlo::cli {
namespace {

using compare::MapColumn;
using compare::Outcome;
using compare::StabilityResult;

/// Returns a count with at most 3 significant digits: 812, 20k, 1.5M.
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

const char* state(Outcome outcome) {
  return outcome == Outcome::pass ? "stable" : compare::to_string(outcome);
}

}  // namespace

std::string hard_cases_text(const std::vector<StabilityResult>& results, std::size_t steppers) {
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
    // A refusal applies to the case, so it is printed for the first stepper only.
    const bool repeated = result.outcome == Outcome::refused && i % steppers > 0;
    if (result.note.empty() || creeping(result) || repeated) continue;
    append(notes, "    {}: {}\n",
           result.outcome == Outcome::refused ? "all" : compare::to_string(result.stepper),
           result.note);
  }
  return outcomes + steps + notes;
}

Json hard_cases_json(const std::vector<StabilityResult>& results) {
  Json cases = json_list(results, [&](const StabilityResult& r) -> Json {
    return {{"case", r.name},
            {"what", r.what},
            {"stepper", compare::to_string(r.stepper)},
            {"outcome", compare::to_string(r.outcome)},
            {"steps", r.steps},
            {"error_over_length", r.error_over_length},
            {"at_rest", r.at_rest},
            {"note", r.note}};
  });
  return {{"schema", "dlo/stability/1"}, {"cases", std::move(cases)}};
}

std::string hard_cases_csv(const std::vector<StabilityResult>& results) {
  const compare::CsvTable table("case,stepper,outcome,steps,error_over_length,at_rest,note");
  return table.text(hard_cases_json(results).at("cases"));
}

std::string stability_map_text(const compare::StabilityMap& map) {
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
         "Table 1 is the paper's proportion {}; above 1 it blows up.\n",
         least, most, compare::table_1_step_formula);
  return out;
}

Json stability_map_json(const compare::StabilityMap& map) {
  Json columns = json_list(map.columns, [&](const MapColumn& c) -> Json {
    return {{"c_c", c.c_c},
            {"c_h", c.c_h},
            {"fastest_mode_N_per_m", c.fastest_mode},
            {"c_F_predicted", c.predicted},
            {"c_F_measured", c.measured},
            {"c_F_table_1", c.table_1}};
  });
  Json points = json_list(map.points, [&](const compare::MapPoint& p) -> Json {
    return {{"c_c", p.c_c}, {"c_h", p.c_h}, {"c_F", p.c_F}, {"state", state(p.outcome)}};
  });
  return {{"schema", "dlo/stability-map/1"},
          {"scene", map.scene},
          {"columns", std::move(columns)},
          {"points", std::move(points)}};
}

std::string stability_map_csv(const compare::StabilityMap& map) {
  const compare::CsvTable table(
      "c_c,c_h,c_F,state,fastest_mode=column/fastest_mode_N_per_m,"
      "c_F_predicted=column/c_F_predicted,c_F_measured=column/c_F_measured");
  const std::size_t rows = map.points.size() / map.columns.size();
  Json document = stability_map_json(map);
  Json& points = document["points"];
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i]["column"] = document["columns"][i / rows];
  return table.text(points);
}

}  // namespace dlo::cli
