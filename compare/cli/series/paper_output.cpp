#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/number.hpp"
#include "base/quote.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "format/result_output.hpp"
#include "option/output.hpp"
#include "paper/printed_tables.hpp"
#include "series/study_output.hpp"

namespace dlo::cli {
namespace {

using compare::PaperReport;
using compare::PaperWeight;

void add_tables(std::string& out, const PaperReport& report) {
  append(out, "Tables 1 and 5 recomputed\n\n  {:<7}{:<12}{:>14}{:>16}  \n", "table", "quantity",
         "printed", "computed");
  for (const compare::TableRow& row : report.tables) {
    append(out, "  {:<7}{:<12}{:>14}{:>16.8g}  {:<4} {}  {}\n", row.table, row.quantity,
           row.printed, row.computed, row.unit, row.agrees ? "agrees " : "differs",
           row.explanation);
  }
}

void add_shapes(std::string& out, const PaperReport& report) {
  append(out,
         "\nShapes of Figs. 12 and 13 [m], force model at rest with c_c = {} N | energy "
         "model at E\n",
         report.c_c);
  for (const compare::PaperCase& entry : report.cases) {
    if (entry.weight == PaperWeight::printed) continue;
    const compare::Comparison& c = entry.rest;
    append(out, "\n  {}\n  {:>9} {:>12} {:>12} | {:>12} {:>12} | {:>9}\n", c.scene, "s", "x", "y",
           "x", "y", "apart");
    for (Eigen::Index i = 0; i < c.force.shape.points.cols(); ++i) {
      const Eigen::Vector3d force = c.force.shape.points.col(i);
      const Eigen::Vector3d energy = c.reference.points.col(i);
      append(out, "  {:9.5f} {:12.7f} {:12.7f} | {:12.7f} {:12.7f} | {:9.7f}\n",
             c.force.shape.arc_length[static_cast<std::size_t>(i)], force.x(), force.y(),
             energy.x(), energy.y(), (force - energy).norm());
    }
  }
  out += "\n";
  for (const compare::PaperCase& entry : report.cases) {
    if (entry.weight == PaperWeight::of_the_rod) out += comparison_text(entry.rest);
  }
}

/// Adds E*/E over time for one choice of the points' weight.
void add_creep(std::string& out, const PaperReport& report, PaperWeight weight) {
  std::vector<const compare::PaperCase*> cases;
  for (const compare::PaperCase& entry : report.cases) {
    if (entry.weight == weight) cases.push_back(&entry);
  }
  append(out,
         "E*/E on the way to rest, {:.5f} N a point{}: stepper basic, {:g} steps/s, c_F = {:.4g} "
         "m/N. The paper says 1/3.\n  {:>7} {:>9}",
         cases.front()->rest.force.parameters.point_weight,
         weight == PaperWeight::printed ? " as printed" : "", report.steps_per_second, report.c_F,
         "t [s]", "steps");
  for (const compare::PaperCase* entry : cases) append(out, "  {:>34}", entry->rest.scene);
  append(out, "\n  {:>7} {:>9}", "", "");
  for (std::size_t i = 0; i < cases.size(); ++i) {
    append(out, "  {:>8} {:>11} {:>13}", "E*/E", "residual", "from rest");
  }
  out += "\n";
  const auto add_modulus = [&](const compare::PaperCase& entry,
                               const compare::EffectiveModulus& modulus, double from_rest) {
    const double length = entry.rest.force.shape.arc_length.back();
    append(out, "  {:>8.4f} {:>9.4f} % {:>11.4f} %", modulus.ratio, modulus.rms_m / length * 100,
           from_rest * 100);
  };
  for (std::size_t row = 0; row < cases.front()->creep.size(); ++row) {
    const compare::ModulusAtTime& first = cases.front()->creep[row];
    append(out, "  {:>7g} {:>9}", first.time_s, first.steps);
    for (const compare::PaperCase* entry : cases) {
      const compare::ModulusAtTime& at = entry->creep[row];
      add_modulus(*entry, at.modulus, at.rest_distance_over_length);
    }
    out += "\n";
  }
  append(out, "  {:>7} {:>9}", "rest", "");
  for (const compare::PaperCase* entry : cases) {
    add_modulus(*entry, entry->rest.effective_modulus, 0);
  }
  out += "\n\n";
}

void add_variants(std::string& out, const PaperReport& report) {
  append(out,
         "E*/E at rest, {}: what it depends on (chain model, no steps)\n"
         "  {:<28} {:>9} {:>4} {:<6} {:<11} {:<15} {:>9} {:>11} {:>12}\n",
         report.cases.front().rest.scene, "varied", "Gamma", "N", "law", "bookkeeping", "c_b from",
         "E*/E", "residual", "RMS at E");
  for (const compare::ModulusVariant& v : report.variants) {
    const double length = report.cases.front().rest.force.shape.arc_length.back();
    append(out, "  {:<28} {:>9.4g} {:>4} {:<6} {:<11} {:<15} {:>9.4f} {:>9.4f} % {:>10.4f} % {}\n",
           v.what, v.gamma, v.settings.points, compare::to_string(v.settings.law),
           compare::to_string(v.settings.bookkeeping),
           v.settings.law == compare::BendingLaw::hooke
               ? "-"
               : compare::to_string(v.settings.bending_rule),
           v.modulus.ratio, v.modulus.rms_m / length * 100, v.rms_over_length * 100,
           v.modulus.optimum == compare::Optimum::clear
               ? ""
               : fmt::format("({})", compare::to_string(v.modulus.optimum)));
  }
}

void add_summary(std::string& out, const PaperReport& report) {
  out += "The paper: its shapes look like the energy model's for E/3. Measured here:\n\n";
  append(out, "  {:<24} {:>16} {:>14} {:>12} {:>22}\n", "", "weight a point", "E*/E at rest",
         "residual", "E*/E passes 1/3 at");
  for (const compare::PaperCase& entry : report.cases) {
    const compare::EffectiveModulus& modulus = entry.rest.effective_modulus;
    append(out, "  {:<24} {:>14.5f} N {:>14.4f} {:>8.2f} % l {:>20.1f} s\n", entry.rest.scene,
           entry.rest.force.parameters.point_weight, modulus.ratio,
           modulus.rms_m / entry.rest.force.shape.arc_length.back() * 100,
           entry.time_at_one_third());
  }
  double softest = HUGE_VAL, stiffest = 0, first = HUGE_VAL, last = 0;
  for (const compare::PaperCase& entry : report.cases) {
    softest = std::min(softest, entry.rest.effective_modulus.ratio);
    stiffest = std::max(stiffest, entry.rest.effective_modulus.ratio);
    first = std::min(first, entry.time_at_one_third());
    last = std::max(last, entry.time_at_one_third());
  }
  append(
      out,
      "\nAt rest E*/E is 1/{:.0f} to 1/{:.0f}. It is 1/3 on the way there, after {:.1f} to {:.1f} "
      "s "
      "of simulated\ntime; the paper's simulations took 28 s. The weight {} N is what Table 5 "
      "prints; the energy\nmodel keeps rho A g, {:.5f} N a point.\n\n",
      1 / stiffest, 1 / softest, first, last, compare::printed_point_weight(),
      report.cases.front().rest.force.parameters.point_weight);
}

}  // namespace

std::string paper_text(const PaperReport& report) {
  std::string out;
  add_summary(out, report);
  add_tables(out, report);
  add_shapes(out, report);
  add_creep(out, report, PaperWeight::of_the_rod);
  add_creep(out, report, PaperWeight::printed);
  add_variants(out, report);
  out += "\nFilled in or assumed\n";
  for (const std::string& assumption : report.assumptions) out += "  - " + assumption + "\n";
  return out;
}

Json paper_json(const PaperReport& report) {
  Json tables = json_list(report.tables, [&](const compare::TableRow& row) -> Json {
    return {{"table", row.table},
            {"quantity", row.quantity},
            {"unit", row.unit},
            {"printed", row.printed},
            {"computed", row.computed},
            {"agrees", row.agrees},
            {"explanation", row.explanation}};
  });
  Json cases = Json::array();
  for (const compare::PaperCase& entry : report.cases) {
    Json creep = Json::array();
    for (const compare::ModulusAtTime& at : entry.creep) {
      Json row = {{"time_s", at.time_s}, {"steps", at.steps}};
      row.update(modulus_json(at.modulus));
      row["rms_over_length"] = at.rms_over_length;
      row["distance_to_rest_over_length"] = at.rest_distance_over_length;
      creep.push_back(std::move(row));
    }
    Json rest = comparison_json(entry.rest);
    rest["point_weight"] = entry.weight == PaperWeight::printed ? "printed" : "rho A l g / N";
    rest["time_at_one_third_s"] = entry.time_at_one_third();
    rest["modulus_against_time"] = std::move(creep);
    cases.push_back(std::move(rest));
  }
  Json variants = Json::array();
  for (const compare::ModulusVariant& variant : report.variants) {
    Json row = {{"varied", variant.what},
                {"load_factor", variant.load_factor},
                {"gamma", variant.gamma},
                {"points", variant.settings.points},
                {"law", compare::to_string(variant.settings.law)},
                {"bookkeeping", compare::to_string(variant.settings.bookkeeping)},
                {"bending_rule", compare::to_string(variant.settings.bending_rule)}};
    row.update(modulus_json(variant.modulus));
    row["rms_over_length"] = variant.rms_over_length;
    variants.push_back(std::move(row));
  }
  return {{"schema", "dlo/paper/1"},
          {"claim", "the paper: E*/E = 1/3"},
          {"c_c_N", report.c_c},
          {"c_F_on_the_way_m_per_N", report.c_F},
          {"steps_per_second", report.steps_per_second},
          {"tables", std::move(tables)},
          {"cases", std::move(cases)},
          {"variants", std::move(variants)},
          {"assumptions", report.assumptions}};
}

std::string paper_csv(const PaperReport& report) {
  std::string out = "section,scene,item,quantity,value\n";
  const auto add = [&](const std::string& section, const std::string& scene,
                       const std::string& item, const std::string& quantity, double value) {
    append(out, "{},{},{},{},{}\n", section, compare::csv_field(scene), compare::csv_field(item),
           quantity, compare::csv_number(value, 12));
  };
  for (const compare::TableRow& row : report.tables) {
    add("table", "", "table " + row.table + " " + row.quantity, "printed",
        *compare::as_number<double>(row.printed));
    add("table", "", "table " + row.table + " " + row.quantity, "computed", row.computed);
  }
  for (const compare::PaperCase& entry : report.cases) {
    const compare::Comparison& c = entry.rest;
    const std::string weight = entry.weight == PaperWeight::printed ? " printed weight" : "";
    for (Eigen::Index i = 0; i < c.force.shape.points.cols(); ++i) {
      const std::string item =
          fmt::format("s={:.9g}", c.force.shape.arc_length[static_cast<std::size_t>(i)]);
      add("shape" + weight, c.scene, item, "force_x_m", c.force.shape.points(0, i));
      add("shape" + weight, c.scene, item, "force_y_m", c.force.shape.points(1, i));
      add("shape" + weight, c.scene, item, "energy_x_m", c.reference.points(0, i));
      add("shape" + weight, c.scene, item, "energy_y_m", c.reference.points(1, i));
    }
    add("rest" + weight, c.scene, "", "rms_m", c.deviation.rms_m);
    add("rest" + weight, c.scene, "", "effective_modulus_ratio", c.effective_modulus.ratio);
    add("rest" + weight, c.scene, "", "rms_at_effective_modulus_m", c.effective_modulus.rms_m);
    for (const compare::ModulusAtTime& at : entry.creep) {
      const std::string item = fmt::format("t={:g}", at.time_s);
      add("creep" + weight, c.scene, item, "effective_modulus_ratio", at.modulus.ratio);
      add("creep" + weight, c.scene, item, "rms_at_effective_modulus_m", at.modulus.rms_m);
      add("creep" + weight, c.scene, item, "distance_to_rest_over_length",
          at.rest_distance_over_length);
    }
  }
  for (const compare::ModulusVariant& v : report.variants) {
    const std::string item = fmt::format(
        "{} gamma={:.6g} points={} law={} bookkeeping={}", v.what, v.gamma, v.settings.points,
        compare::to_string(v.settings.law), compare::to_string(v.settings.bookkeeping));
    add("variant", "", item, "effective_modulus_ratio", v.modulus.ratio);
    add("variant", "", item, "rms_at_effective_modulus_m", v.modulus.rms_m);
  }
  return out;
}

}  // namespace dlo::cli
