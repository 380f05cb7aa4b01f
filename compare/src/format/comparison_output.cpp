#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/number.hpp"
#include "base/text.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/shape_verdict.hpp"
#include "format/result_output.hpp"
#include "judge/budget_parts.hpp"
#include "record/csv_table.hpp"
#include "record/solution_fields.hpp"

namespace dlo::cli {
namespace {

/// Returns the shown parts of the error budget, then the total. A share is the projection of a part
/// on the total, so that the shares add up to 1; that of a part orthogonal to the total is 0.
Json budget_rows(const compare::Comparison& comparison) {
  Json rows = json_list(compare::shown_parts(comparison), [](const auto& row) -> Json {
    return {
        {"part", row.first}, {"rms_m", row.second->rms_m}, {"share_of_total", row.second->share}};
  });
  rows.push_back({{"part", "total"}, {"rms_m", comparison.budget.total_m}, {"share_of_total", 1}});
  return rows;
}

}  // namespace

void add_largest_and_rms(std::string& out, const compare::Deviation& d) {
  append(out, "  deviation       RMS {:.4g} mm = {:.4g} % of l", d.rms_m * 1e3,
         d.rms_over_length * 100);
  if (std::isfinite(d.rms_over_movement)) {
    append(out, " = {:.4g} % of the movement", d.rms_over_movement * 100);
  }
  append(out, "\n                  largest {:.4g} mm at s = {:.4f} m", d.max_m * 1e3, d.max_at_m);
}

void add_modulus(std::string& out, const compare::EffectiveModulus& modulus, double movement_m,
                 const compare::NamedValue& of, double value) {
  const std::string ratio = fmt::format("{0}*/{0}", of.name);
  if (modulus.optimum == compare::Optimum::none) {
    append(out, "  {:<15} not determined: {}\n", ratio, modulus.missing_reason);
    return;
  }
  append(out, "  {:<15} {:.4f}", ratio, modulus.ratio);
  if (std::isfinite(value)) append(out, " ({}* = {:.4g} {})", of.name, value, of.unit);
  append(out, ", where the RMS is {:.4g} mm", modulus.rms_m * 1e3);
  if (std::isfinite(movement_m)) {
    append(out, " = {:.4g} % of the movement", modulus.rms_m / movement_m * 100);
  }
  append(out, " ({} optimum", compare::to_string(modulus.optimum));
  if (std::isfinite(modulus.explained_share)) {
    // Rounded down, so that 100 % is not printed if anything remains.
    append(out, ": {}* explains {:.4g} % of the mean square", of.name,
           std::floor(modulus.explained_share * 1e4) / 100);
  }
  if (modulus.at_bifurcation) {
    append(out, ", where the equilibrium that is followed ends or bifurcates: no measure of {}",
           of.name);
  }
  if (modulus.rms_m > movement_m) out += ", but leaves more than the rod moved";
  out += ")\n";
}

bool within_limit(const compare::Comparison& c) {
  return c.deviation.rms_m <= compare::default_tolerance(c.length).allowed_m;
}

std::string comparison_text(const compare::Comparison& c) {
  std::string out =
      fmt::format("{}: {}, RMS {:.4g} mm, limit {:.4g} mm = 1 % of l", compare::display(c.scene),
                  within_limit(c) ? "pass" : "fail", c.deviation.rms_m * 1e3,
                  compare::default_tolerance(c.length).allowed_m * 1e3);
  const auto parts = compare::shown_parts(c);
  const auto largest =
      std::ranges::max_element(parts, {}, [](const auto& part) { return part.second->share; });
  if (!within_limit(c) && largest != parts.end()) {
    append(out, "; largest part: {}, {:.4g} %", largest->first, largest->second->share * 100);
  }
  out += "\n";
  if (!c.unverified.empty()) {
    append(out, "  reference       {}: nothing below is proven\n", c.unverified);
  }
  add_largest_and_rms(out, c.deviation);
  out += "\n";
  if (c.unverified.empty()) {
    add_modulus(out, c.effective_modulus, c.deviation.rms_m / c.deviation.rms_over_movement,
                c.stiffness, NAN);
  }
  compare::Document details{
      .json = picked(comparison_json(c),
                     {"gamma", "law", "bookkeeping", "points", "undeformed_rms_over_length",
                      "neglected", "contacts", "state/energy_above_lowest_J", "state/stable_found",
                      "state/unstable_found", "state/others"}),
      .large = {.length = c.length, .energy = std::abs(c.state.energy_J)}};
  if (details.json.contains("contacts")) count_from_1(details.json["contacts"]);
  details.json["error_budget"] = budget_rows(c);
  return out + "\n" + details.text() + "\n";
}

Json comparison_json(const compare::Comparison& comparison) {
  const compare::Budget& budget = comparison.budget;
  Json result = {{"scene", comparison.scene},
                 {"gamma", comparison.gamma},
                 {"law", compare::to_string(comparison.settings.law)},
                 {"bookkeeping", compare::to_string(comparison.settings.bookkeeping)},
                 {"points", comparison.settings.points},
                 {"deviation", compare::json_of(compare::numbers_of(compare::deviation_fields(),
                                                                    comparison.deviation))},
                 {"undeformed_rms_over_length", comparison.undeformed_rms_over_length}};
  result.update(modulus_json(comparison.effective_modulus));
  result["parameters"] = parameters_json(comparison.force, comparison.settings);
  result["residual_over_movement"] = comparison.residual_over_displacement;
  Json& parts = result["budget"] = Json::object();
  Json shares = Json::object();
  for (const compare::NamedPart& part : compare::budget_parts()) {
    if (part.is_neglected && !neglects(comparison.force, part.name)) continue;
    std::string key = part.name;
    std::ranges::replace(key, ' ', '_');
    parts[key + "_m"] = (budget.*part.of).rms_m;
    shares[key] = (budget.*part.of).share;
  }
  parts["total_m"] = budget.total_m;
  parts["shares_of_total"] = std::move(shares);
  if (!comparison.force.neglected.empty()) result["neglected"] = comparison.force.neglected;
  if (!comparison.contacts.empty()) result["contacts"] = contacts_json(comparison.contacts);
  result["reference_verified"] = comparison.unverified.empty();
  result["state"] = to_json(comparison.state);
  result["cost"] = {{"force_s", comparison.force.seconds},
                    {"force_steps", comparison.force.steps},
                    {"energy_s", comparison.energy_seconds},
                    {"energy_evaluations", comparison.energy_evaluations}};
  if (comparison.plan) result["plan"] = plan_json(*comparison.plan);
  result["arc_length_m"] = comparison.force.shape.arc_length;
  result["force_points_m"] = points_json(comparison.force.shape.points);
  result["energy_points_m"] = points_json(comparison.reference.points);
  return result;
}

std::string comparisons_csv(const std::vector<compare::Comparison>& comparisons) {
  const compare::CsvTable table(
      "scene,law,bookkeeping,points,gamma,rms_m=deviation/rms_m,max_m=deviation/max_m,"
      "tip_m=deviation/tip_m,rms_over_length=deviation/rms_over_length,"
      "rms_over_movement=deviation/rms_over_movement,effective_modulus_ratio,"
      "rms_at_effective_modulus_m,optimum,c_b,c_c=parameters/c_c,budget_twist_m,"
      "budget_natural_curvature_m,budget_law_m=budget/law_m,"
      "budget_bookkeeping_m=budget/bookkeeping_m,budget_discretisation_m=budget/discretisation_m,"
      "budget_stretch_m=budget/stretch_m,budget_contact_m=budget/contact_m,"
      "budget_not_at_rest_m=budget/not_at_rest_m,budget_interaction_m=budget/interaction_m,"
      "budget_parts_share,residual_over_movement,state_rank=state/rank_of_stable,"
      "states_stable=state/stable_found,force_steps=cost/force_steps,force_s=cost/force_s:4,"
      "energy_evaluations=cost/energy_evaluations,energy_s=cost/energy_s:4");
  std::string text = table.header();
  for (const compare::Comparison& c : comparisons) {
    Json row = comparison_json(c);
    row["c_b"] = c.force.parameters.c_b;
    row["budget_twist_m"] = c.budget.twist.rms_m;
    row["budget_natural_curvature_m"] = c.budget.natural_curvature.rms_m;
    row["budget_parts_share"] = 1 - c.budget.interaction.share;
    text += table.row(row);
  }
  return text;
}

Json comparisons_json(const std::vector<compare::Comparison>& comparisons) {
  return {{"schema", "dlo/compare/1"}, {"cases", json_list(comparisons, comparison_json)}};
}

std::string pose_text(const compare::RigidMotion& pose, double length) {
  const Eigen::AngleAxisd turn(pose.rotation);
  const Eigen::Vector3d axis = shown(turn.axis(), 1);
  const Eigen::Vector3d move = shown(pose.translation, length);
  return compare::formatted(
      "rotated by {:.3f} deg about [{:.4f}, {:.4f}, {:.4f}], then moved [{:.6g}, {:.6g}, {:.6g}] m",
      turn.angle() * 57.29577951308232, axis.x(), axis.y(), axis.z(), move.x(), move.y(), move.z());
}

Json to_json(const compare::Alignment& alignment) {
  return {{"reversed", alignment.reversed},
          {"arc_lengths", compare::to_string(alignment.arc_lengths)},
          {"pose",
           {{"rotation", points_json(alignment.pose.rotation.transpose())},
            {"translation_m", to_json(alignment.pose.translation)}}}};
}

}  // namespace dlo::cli
