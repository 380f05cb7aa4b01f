#include <algorithm>
#include <cmath>

#include "base/quote.hpp"
#include "base/text.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "format/result_output.hpp"
#include "record/csv_table.hpp"

namespace dlo::cli {
namespace {

using compare::ForceModelFit;
using compare::RuleDeviations;

bool is_holdout(const ForceModelFit& fit, std::size_t i) {
  return i + fit.holdouts >= fit.scenes.size();
}

std::string percent(double share) {
  return std::isfinite(share) ? fmt::format("{:.3g} %", share * 100) : "-";
}

const char* c_c_origin(const ForceModelFit& fit) {
  if (fit.c_c_was_given) return "as given";
  return fit.c_c_is_physical ? "A E of the rod"
                             : "stretches the rod by a tenth of the target at most";
}

Json force_model_json(const ForceModelFit& fit) {
  const compare::ForceModelSettings& s = fit.settings;
  Json scenes = Json::array();
  for (std::size_t i = 0; i < fit.scenes.size(); ++i) {
    Json rules = Json::object();
    for (const RuleDeviations& rule : fit.rules) {
      Json entry = {{"rms_over_length", rule.rms_over_length[i]}};
      if (!rule.c_b.empty()) entry["c_b"] = rule.c_b[i];
      rules[compare::to_string(rule.rule)] = std::move(entry);
    }
    scenes.push_back({{"scene", fit.scenes[i]},
                      {"gamma", fit.gammas[i]},
                      {"holdout", is_holdout(fit, i)},
                      {"rms_over_length", fit.stepped_rms_over_length[i]},
                      {"stretch_rms_over_length", fit.stretch_rms_over_length[i]},
                      {"steps", fit.steps[i]},
                      {"rules", std::move(rules)}});
  }
  return {{"schema", "dlo/calibrate/1"},
          {"parameters",
           {{"law", compare::to_string(s.law)},
            {"bookkeeping", compare::to_string(s.bookkeeping)},
            {"points", s.points},
            {"c_b", json_or_null(s.c_b)},
            {"bending_stiffness_Nm2", fit.bending_stiffness},
            {"segment_length_m", fit.segment_length},
            {"c_c", *s.c_c},
            {"stepper", compare::to_string(s.stepper)},
            {"c_F", json_or_null(s.c_F)},
            {"c_h", json_or_null(s.c_h)},
            {"l_s", json_or_null(s.l_s)}}},
          {"order_of_convergence", fit.order > 0 ? Json(fit.order) : Json(nullptr)},
          {"target", fit.target},
          {"reached", fit.reaches_target()},
          {"why_missed", fit.shortfall_reasons()},
          {"deviation",
           {{"worst_rms_over_length", fit.largest_deviation()},
            {"worst_holdout_rms_over_length",
             fit.holdouts > 0 ? Json(fit.largest_holdout_deviation()) : Json(nullptr)}}},
          {"scenes", std::move(scenes)}};
}

}  // namespace

std::string force_model_csv(const ForceModelFit& fit) {
  compare::CsvTable table(
      "scene,gamma,holdout,law=parameters/law,bookkeeping=parameters/bookkeeping,"
      "points=parameters/points,c_c=parameters/c_c,c_F=parameters/c_F,c_h=parameters/c_h,"
      "l_s=parameters/l_s,c_b=parameters/c_b");
  for (const RuleDeviations& rule : fit.rules) {
    table.add(fmt::format("rms_over_length_{0}=rules/{0}/rms_over_length",
                          compare::to_string(rule.rule)));
  }
  table.add("rms_over_length_stepped=rms_over_length,steps");
  Json document = force_model_json(fit);
  for (Json& row : document["scenes"]) row["parameters"] = document["parameters"];
  return table.text(document["scenes"]);
}

compare::Document force_model_document(const ForceModelFit& fit, bool target_was_given) {
  compare::Document document{.json = force_model_json(fit)};
  std::string& out = document.head;
  append(out, "worst {}", percent(fit.largest_deviation()));
  if (fit.holdouts > 0)
    append(out, ", of the hold-out scenes {}", percent(fit.largest_holdout_deviation()));
  append(out, " of l (RMS): the {} of {} is {}\n", target_was_given ? "target" : "default target",
         percent(fit.target), fit.reaches_target() ? "reached" : "not reached");
  for (const std::string& reason : fit.shortfall_reasons()) {
    append(out, "  {}\n", compare::wrap(reason, 2, 100));
  }
  append(out, "  c_c: {}\n\n", c_c_origin(fit));
  document.shown = document.json;
  for (const char* key : {"target", "reached", "why_missed", "deviation"}) {
    document.shown.erase(key);
  }
  std::string& columns = document.columns["scenes"];
  columns = "scene,gamma,holdout";
  for (const RuleDeviations& rule : fit.rules) {
    append(columns, ",{0}_over_length=rules/{0}/rms_over_length", compare::to_string(rule.rule));
  }
  columns += ",stepped_over_length=rms_over_length,steps";
  return document;
}

std::string force_model_toml(const ForceModelFit& fit) {
  const compare::ForceModelSettings& s = fit.settings;
  const bool hooke = s.law == compare::BendingLaw::hooke;
  std::string out =
      "# Parameters of the force model, written by dlo calibrate from these scenes:\n";
  for (std::size_t i = 0; i < fit.scenes.size(); ++i) {
    std::string name = fit.scenes[i];
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return c < ' '; }, ' ');
    append(out, "#   {} (Gamma = {:.4g}): RMS deviation {} of the length{}\n", name, fit.gammas[i],
           percent(fit.stepped_rms_over_length[i]), is_holdout(fit, i) ? ", held out" : "");
  }
  append(out, "# Target {}: {}.\n", percent(fit.target),
         fit.reaches_target() ? "reached" : "not reached");
  append(out, "# dlo reads it with --parameters. Lengths in m, forces in N.\n\n[force_model]\n");
  append(out, "law = \"{}\"\nbookkeeping = \"{}\"\n", compare::to_string(s.law),
         compare::to_string(s.bookkeeping));
  append(out, "points = {}  # N\n", s.points);
  if (s.c_b) {
    append(out, "c_b = {:.9e}  # N, bending stiffness: {}\n", *s.c_b,
           fit.c_b_was_given ? "as given" : "fitted to the scenes' energy shapes");
  }
  append(out, "c_c = {:.9e}  # N, stretch stiffness: {}\n", *s.c_c, c_c_origin(fit));
  append(out, "stepper = \"{}\"{}\n", compare::to_string(s.stepper),
         s.c_F ? "  # Formulas 19 and 20" : "");
  if (s.c_F) {
    append(out, "c_F = {:.9e}  # m/N, heavy ball of the stiffest and slowest modes\n", *s.c_F);
    append(out, "c_h = {:.9f}  # share of the last movement that is kept, likewise\n", *s.c_h);
    append(out, "l_s = {:.9e}  # m, largest relative movement per step: L/4\n", *s.l_s);
  }
  append(out, "\n[derived]  # for programs of your own, of the first scene\n");
  append(out, "segment_length = {:.9e}  # m, L\n", fit.segment_length);
  append(out, "bending_stiffness = {:.9e}  # N m^2, EI{}\n", fit.bending_stiffness,
         hooke ? ": the hooke law's joint moment is 2 (EI/L) tan(alpha/2)" : "");
  return out;
}

}  // namespace dlo::cli
