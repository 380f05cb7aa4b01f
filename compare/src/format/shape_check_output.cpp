#include <algorithm>
#include <cmath>
#include <vector>

#include "base/text.hpp"
#include "dlo/compare/deviation.hpp"
#include "format/result_output.hpp"
#include "record/csv_table.hpp"
#include "record/solution_fields.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::cli {
namespace {

/// Returns what was derived from a simulator's model, for other programs.
Json model_json(const compare::Scene& scene) {
  return {{"made_from", scene.model->words},
          {"segments", scene.model->segments},
          {"length_m", scene.length},
          {"mass_kg", scene.mass()},
          {"bending_stiffness_Nm2", scene.bending_stiffness()},
          {"torsional_stiffness_Nm2", json_or_null(scene.torsional_stiffness)},
          {"notes", scene.model->notes}};
}

void add_explanations(std::string& out, const compare::CheckResult& report) {
  constexpr std::size_t most_explanations = 3;
  for (std::size_t i = 0; i < std::min(most_explanations, report.explanations.size()); ++i) {
    const compare::Explanation& explanation = report.explanations[i];
    append(out, "  {}  RMS {:.4g} mm if {}{}\n", i == 0 ? "explained by  " : "              ",
           explanation.rms_m * 1e3,
           explanation.kind == compare::ExplanationKind::discretisation ? "it is " : "",
           explanation.cause);
  }
}

Json shape_check_json(const compare::CheckResult& report) {
  const compare::ShapeCheck& c = report.check;
  const std::vector<double>& s = c.reference.arc_length;
  Json result = {{"schema", "dlo/check/1"},
                 {"scene", c.scene},
                 {"shape", c.file},
                 {"gamma", c.gamma},
                 {"points", s.size()}};
  if (report.scene.model) result["model"] = model_json(report.scene);
  if (!report.notes.empty()) result["notes"] = report.notes;
  result.update(to_json(c.alignment));
  result["direction_is_clear"] = c.is_direction_determined;
  result["turn_is_clear"] = c.is_rotation_determined;
  result["seen"] = {{"from_m", s.front()},
                    {"to_m", s.back()},
                    {"share", c.observed_share},
                    {"polyline_length_m", c.polyline_length_m},
                    {"largest_gap_m", c.largest_gap_m},
                    {"largest_gap_at_m", c.largest_gap_at_m},
                    {"excess_m", c.length_beyond_ends_m}};
  result["hint"] = text_or_null(c.hint);
  result["deviation"] =
      compare::json_of(compare::numbers_of(compare::deviation_fields(), c.deviation));
  result["deviation"]["whole_rms_m"] = c.whole_rod_rms_m;
  result["deviation"]["whole_max_m"] = c.whole_rod_max_m;
  result["deviation"]["worst_point"] = c.worst_point;
  result["deviation"]["worst_position_m"] = to_json(c.worst_position);
  result["movement_m"] = c.movement_m;
  result.update(modulus_json(c.effective_modulus));
  const bool given_by_EI = report.scene.given_bending_stiffness.has_value();
  result[given_by_EI ? "effective_bending_stiffness_Nm2" : "effective_modulus_Pa"] = c.modulus;
  result["superseded_by"] =
      report.superseding_cause ? Json(report.superseding_cause->cause) : Json();
  result["tolerance"] = {{"measure", report.tolerance.largest ? "max" : "rms"},
                         {"allowed_m", report.tolerance.allowed_m},
                         {"of_deflection", report.tolerance.deflection_share > 0},
                         {"least_seen_share", report.tolerance.least_observed_share},
                         {"part", report.tolerance.part},
                         {"default", report.tolerance.by_default}};
  result["judged_m"] = report.judgement.judged_m;
  result["verdict"] = compare::to_string(report.judgement.verdict);
  result["significant"] = json_or_null(report.judgement.significant);
  result["deflection_m"] = report.deflection_m;
  result["reason"] = report.judgement.reason;
  result["explanations"] =
      json_list(report.explanations, [](const compare::Explanation& explanation) -> Json {
        return {{"cause", explanation.cause},
                {"kind", compare::to_string(explanation.kind)},
                {"numbers", explanation.numbers},
                {"rms_m", explanation.rms_m}};
      });
  result["state"] = to_json(c.state);
  if (compare::is_friction_in_reach(report.scene)) result["neglected"] = {"friction"};
  result["arc_length_m"] = s;
  result["points_m"] = points_json(c.alignment.shape.points);
  result["reference_points_m"] = points_json(c.reference.points);
  return result;
}

}  // namespace

std::string markdown(const std::string& text) {
  std::string out;
  for (const char c : compare::display(text)) {
    if (std::string_view("\\`*_[]<>|#&").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

compare::Document shape_check_document(const CheckPage& page) {
  const compare::CheckResult& report = page.result;
  const compare::ShapeCheck& c = report.check;
  std::string out = fmt::format(
      "{}: {}\n",
      page.verdict.empty() ? compare::to_string(report.judgement.verdict) : page.verdict,
      report.judgement.reason);
  const std::string both = compare::other_stiffness_within(report);
  if (!both.empty()) append(out, "  ({})\n", both);
  add_largest_and_rms(out, c.deviation);
  const Eigen::Vector3d at = shown(c.worst_position, report.scene.length);
  append(out, " (point {} of the file, at [{:.4g}, {:.4g}, {:.4g}] m)\n", c.worst_point, at.x(),
         at.y(), at.z());
  if (report.superseding_cause) {
    append(out,
           "  {:<15} not meaningful: the best stiffness leaves {:.4g} mm (RMS), the best cause "
           "{:.4g} mm\n",
           fmt::format("{0}*/{0}", c.stiffness.name), c.effective_modulus.rms_m * 1e3,
           report.superseding_cause->rms_m * 1e3);
  } else {
    add_modulus(out, c.effective_modulus, NAN, c.stiffness, c.modulus);
  }
  add_explanations(out, report);
  const std::string hint = c.hint.empty() ? page.unit_hint : c.hint;
  if (!hint.empty()) append(out, "  hint            {}\n", hint);
  if (report.pose != compare::PoseFreedom::known) {
    append(out, "  frame           found ({}): {}\n", compare::to_string(report.pose),
           pose_text(c.alignment.pose, report.scene.length));
  }
  compare::Document document{
      .json = shape_check_json(report),
      .columns =
          {{"",
            "scene,shape,gamma,points,reversed,arc_lengths,from_m=seen/from_m,to_m=seen/to_m,"
            "rms_m=deviation/rms_m,rms_over_length=deviation/rms_over_length,"
            "rms_over_movement=deviation/rms_over_movement,max_m=deviation/max_m,"
            "max_at_m=deviation/max_at_m,worst_point=deviation/worst_point,"
            "tip_m=deviation/tip_m,movement_m,effective_modulus_ratio,"
            "rms_at_effective_modulus_m,optimum,tolerance_m=tolerance/allowed_m,verdict,"
            "seen_share=seen/share,reason,whole_rms_m=deviation/whole_rms_m,"
            "whole_max_m=deviation/whole_max_m,significant,deflection_m"}},
      .large = compare::magnitudes(report.scene),
      .head = out + "\n"};
  document.shown = picked(
      document.json, {"scene", "shape", "points", "model", "notes", "arc_lengths", "seen/from_m",
                      "seen/to_m", "seen/share", "seen/polyline_length_m", "seen/largest_gap_m",
                      "movement_m", "state/energy_J", "state/energy_above_lowest_J",
                      "state/stable_found", "state/searched", "state/others", "neglected"});
  for (const char* key : {"direction_is_clear", "turn_is_clear"}) {
    if (!document.json.at(key)) document.shown[key] = false;
  }
  return document;
}

std::string shape_check_markdown(const compare::CheckResult& report) {
  return fmt::format("### {} {}: {}\n\n````\n{}````\n", report.passes() ? "\u2705" : "\u274c",
                     compare::to_string(report.judgement.verdict), markdown(report.check.scene),
                     shape_check_document({report}).text());
}

}  // namespace dlo::cli
