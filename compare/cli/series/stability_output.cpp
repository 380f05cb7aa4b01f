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

const char* state(Outcome outcome) {
  return outcome == Outcome::pass ? "stable" : compare::to_string(outcome);
}

}  // namespace

compare::Document hard_cases_document(const std::vector<StabilityResult>& results) {
  Json cases = json_list(results, [&](const StabilityResult& r) -> Json {
    return {{"case", r.name},
            {"what", r.difficulty},
            {"stepper", compare::to_string(r.stepper)},
            {"outcome", compare::to_string(r.outcome)},
            {"steps", r.steps},
            {"error_over_length", r.error_over_length},
            {"at_rest", r.at_rest},
            {"note", r.note}};
  });
  return {.json = {{"schema", "dlo/stability/1"}, {"cases", std::move(cases)}},
          .columns = {{"cases", "case,stepper,outcome,steps,error_over_length,at_rest,note"}},
          .table = "cases"};
}

compare::Document stability_map_document(const compare::StabilityMap& map) {
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
  return {.json = {{"schema", "dlo/stability-map/1"},
                   {"scene", map.scene},
                   {"columns", std::move(columns)},
                   {"points", std::move(points)}},
          .columns = {{"points", ""}}};
}

std::string stability_map_csv(const compare::StabilityMap& map) {
  const compare::CsvTable table(
      "c_c,c_h,c_F,state,fastest_mode=column/fastest_mode_N_per_m,"
      "c_F_predicted=column/c_F_predicted,c_F_measured=column/c_F_measured");
  const std::size_t rows = map.points.size() / map.columns.size();
  Json document = stability_map_document(map).json;
  Json& points = document["points"];
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i]["column"] = document["columns"][i / rows];
  return table.text(points);
}

}  // namespace dlo::cli
