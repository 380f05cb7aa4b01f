#include <fmt/format.h>

#include <utility>
#include <vector>

#include "base/quote.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "format/result_output.hpp"
#include "option/output.hpp"
#include "series/study_output.hpp"

namespace dlo::cli {

compare::Document paper_document(const compare::PaperReport& report,
                                 const compare::MovingReport& moving) {
  Json tables = json_list(report.tables, [&](const compare::TableRow& row) -> Json {
    return {{"table", row.table},
            {"quantity", row.quantity},
            {"unit", row.unit},
            {"printed", row.printed},
            {"computed", row.computed},
            {"agrees", row.agrees},
            {"explanation", row.explanation}};
  });
  Json cases = json_list(report.cases, [](const compare::PaperCase& entry) {
    Json creep = json_list(entry.creep, [](const compare::ModulusAtTime& at) {
      Json row = {{"time_s", at.time_s}, {"steps", at.steps}};
      row.update(modulus_json(at.modulus));
      row["rms_over_length"] = at.rms_over_length;
      row["distance_to_rest_over_length"] = at.rest_distance_over_length;
      return row;
    });
    Json rest = comparison_json(entry.rest);
    rest["point_weight"] =
        entry.weight == compare::PaperWeight::printed ? "printed" : "rho A l g / N";
    rest["time_at_one_third_s"] = entry.time_at_one_third();
    rest["modulus_against_time"] = std::move(creep);
    return rest;
  });
  Json variants = json_list(report.variants, [](const compare::ModulusVariant& variant) {
    Json row = {{"varied", variant.varied},
                {"load_factor", variant.load_factor},
                {"gamma", variant.gamma},
                {"points", variant.settings.points},
                {"law", compare::to_string(variant.settings.law)},
                {"bookkeeping", compare::to_string(variant.settings.bookkeeping)},
                {"bending_rule", compare::to_string(variant.settings.bending_rule)}};
    row.update(modulus_json(variant.modulus));
    row["rms_over_length"] = variant.rms_over_length;
    return row;
  });
  const std::string scan =
      "varied,force_factor=distance/force_factor,counters_near=distance/counters_near,"
      "counters=distance/counters";
  return {.json = {{"schema", "dlo/paper/1"},
                   {"claim", "the paper: E*/E = 1/3"},
                   {"c_c_N", report.c_c},
                   {"c_F_on_the_way_m_per_N", report.c_F},
                   {"steps_per_second", report.steps_per_second},
                   {"tables", std::move(tables)},
                   {"cases", std::move(cases)},
                   {"variants", std::move(variants)},
                   {"assumptions", report.assumptions},
                   {"moving", moving_json(moving)}},
          .columns = {{"cases",
                       "scene,point_weight,gamma,points,effective_modulus_ratio,"
                       "rms_at_effective_modulus_m,time_at_one_third_s,"
                       "rms_over_length=deviation/rms_over_length"},
                      {"cases/#/modulus_against_time",
                       "time_s,steps,effective_modulus_ratio,rms_at_effective_modulus_m,"
                       "distance_to_rest_over_length"},
                      {"variants",
                       "varied,gamma,points,law,bookkeeping,bending_rule,effective_modulus_ratio,"
                       "optimum,rms_at_effective_modulus_m,rms_over_length"},
                      {"moving/rows",
                       "table=printed/table,movement,rod,variant,status,steps,"
                       "printed_steps=printed/steps,c_s_not_1,d_m_above_l_s,average_force_N,"
                       "printed_force_N=printed/average_force_N,"
                       "shape_rms_over_length=error/shape_rms_over_length,"
                       "force_rms_N=error/force_rms_N,point_mass_kg=reading/point_mass_kg"},
                      {"moving/scan", scan},
                      {"moving/table_3_scan", scan}}};
}

std::string paper_csv(const compare::Document& paper) {
  constexpr int digits = 12;
  std::string out = "path,value\n";
  const Json values = paper.json.flatten();
  for (const auto& [path, value] : values.items()) {
    if (!value.is_number()) continue;
    append(out, "{},{}\n", path.substr(1), compare::csv_value(value, digits));
  }
  return out;
}

}  // namespace dlo::cli
