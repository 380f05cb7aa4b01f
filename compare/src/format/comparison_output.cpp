#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/number.hpp"
#include "base/text.hpp"
#include "dlo/compare/deviation.hpp"
#include "format/result_output.hpp"
#include "judge/budget_parts.hpp"
#include "record/csv_table.hpp"
#include "record/solution_fields.hpp"

namespace dlo::cli {
namespace {

void add_budget(std::string& out, const compare::Comparison& comparison) {
  // A share is the projection of a part on the total, so that the shares add up to 1; a part
  // orthogonal to the total has a length in mm, but no share.
  append(out, "  error budget    RMS, and share of the total {:.4g} mm with sign\n",
         comparison.budget.total_m * 1e3);
  for (const auto& [name, part] : compare::shown_parts(comparison)) {
    append(out, "                  {:<17}{:>9.4g} mm {:>9.2f} %\n", name,
           compare::shown(part->rms_m, comparison.length) * 1e3, part->share * 100);
  }
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

void add_angle_and_curvature(std::string& out, const compare::Deviation& d) {
  append(out, "                  tangent RMS {:.4g} deg, curvature RMS {:.4g} 1/m\n",
         d.angle_rms_rad * 57.29577951308232, d.curvature_rms_per_m);
}

void add_state(std::string& out, const compare::ComparedState& state, double length,
               const char* shape) {
  append(out, "  state           ");
  if (!state.searched) {
    append(out, "{:.6g} J; other equilibria were not searched\n", state.energy_J);
  } else {
    const std::string unstable =
        state.unstable == 0 ? "no unstable one" : fmt::format("{} unstable", state.unstable);
    append(out, "{}, {:.6g} J; {}\n",
           state.only_lowest() ? "the only stable one found"
                               : fmt::format("number {} by energy of {} stable ones found{}",
                                             state.rank, state.stable,
                                             state.energy_above_lowest_J() > 0
                                                 ? fmt::format(" ({:.4g} J above the lowest one)",
                                                               state.energy_above_lowest_J())
                                                 : ""),
           state.energy_J,
           state.others.empty() ? "no other equilibrium found" : "besides " + unstable);
  }
  // Symmetric equilibria have identical lines and are combined.
  std::vector<std::pair<std::string, int>> lines;
  for (const compare::OtherState& other : state.others) {
    if (!other.stable && other.rms_from_shape_m >= state.rms_from_shape_m) continue;
    std::string line = compare::formatted(
        "{}, {:+.4g} J, RMS {:.4g} % of l away, {:.4g} % from {}\n",
        other.stable ? "stable" : "unstable", other.energy_difference_J,
        other.rms_from_compared_m / length * 100, other.rms_from_shape_m / length * 100, shape);
    if (lines.empty() || lines.back().first != line) lines.emplace_back(std::move(line), 0);
    ++lines.back().second;
  }
  for (const auto& [line, count] : lines) {
    append(out, "                  other: {}{}", count > 1 ? fmt::format("{} ", count) : "", line);
  }
}

void add_modulus(std::string& out, const compare::EffectiveModulus& modulus, double movement_m,
                 const compare::NamedValue& of, double value) {
  const std::string ratio = fmt::format("{0}*/{0}", of.name);
  if (modulus.optimum == compare::Optimum::none) {
    append(out, "  {:<15} not determined: {}\n", ratio, modulus.why_none);
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

std::string comparison_text(const compare::Comparison& c) {
  std::string out;
  const compare::Parameters& p = c.force.parameters;
  append(out, "{}   Gamma = {:.4g}\n", compare::display(c.scene), c.gamma);
  append(out, "  force model     law {}, bookkeeping {}, N = {}, c_c = {:.6g} N",
         compare::to_string(c.settings.law), compare::to_string(c.settings.bookkeeping),
         c.settings.points, p.c_c);
  if (p.c_b > 0) append(out, ", c_b = {:.6g} N", p.c_b);
  append(out, "\n");
  std::vector<std::string> by_force = c.force.neglected;
  by_force.erase(std::remove(by_force.begin(), by_force.end(), "friction"), by_force.end());
  if (!by_force.empty()) {
    append(out, "  neglected       {} that the scene has, by the force model: in all below\n",
           fmt::join(by_force, ", "));
  }
  if (neglects(c, "friction")) {
    append(out,
           "  neglected       friction that the scene has, by both models: nothing below has it\n");
  }
  if (!c.unverified.empty()) {
    append(out, "  reference       {}: nothing below is proven\n", c.unverified);
  }
  const compare::Deviation& d = c.deviation;
  add_largest_and_rms(out, d);
  if (std::isfinite(d.tip_m)) append(out, ", tip {:.4g} mm", d.tip_m * 1e3);
  out += "\n";
  add_angle_and_curvature(out, d);
  if (std::isfinite(c.undeformed_rms_over_length)) {
    append(out, "                  (the unbent rod would be {:.4g} % of l off)\n",
           c.undeformed_rms_over_length * 100);
  }
  for (const energy_model::ContactPart& contact : c.contacts) {
    append(out, "  contact         {}\n", contact_text(contact));
  }
  if (c.unverified.empty()) {
    const double movement_m = c.deviation.rms_m / c.deviation.rms_over_movement;
    add_modulus(out, c.effective_modulus, movement_m, c.stiffness, NAN);
  }
  add_budget(out, c);
  add_state(out, c.state, c.length, "force");
  append(out, "  cost            force {} steps, {:.3g} ms; energy {} evaluations, {:.3g} ms\n\n",
         c.force.steps, c.force.seconds * 1e3, c.energy_evaluations, c.energy_seconds * 1e3);
  return out;
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
  result["residual_over_movement"] = comparison.residual_over_movement;
  Json& parts = result["budget"] = Json::object();
  Json shares = Json::object();
  for (const compare::NamedPart& part : compare::budget_parts()) {
    if (part.is_neglected && !neglects(comparison, part.name)) continue;
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

std::string range_text(const compare::Alignment& alignment, double length) {
  double from = alignment.shape.arc_length.front();
  double to = alignment.shape.arc_length.back();
  const double near = 1e-4 * length;
  const bool whole = from <= near && to >= length - near;
  if (whole) return alignment.reversed ? "from arc length l to 0" : "from arc length 0 to l";
  if (alignment.reversed) std::swap(from, to);
  return fmt::format("from s = {:.4g} to {:.4g} m", from, to);
}

std::string pose_text(const compare::RigidMotion& pose, double length) {
  const Eigen::AngleAxisd turn(pose.rotation);
  std::string out;
  const Eigen::Vector3d axis = shown(turn.axis(), 1);
  const Eigen::Vector3d move = shown(pose.translation, length);
  append(
      out,
      "rotated by {:.3f} deg about [{:.4f}, {:.4f}, {:.4f}], then moved [{:.6g}, {:.6g}, {:.6g}] m",
      turn.angle() * 57.29577951308232, axis.x(), axis.y(), axis.z(), move.x(), move.y(), move.z());
  return out;
}

Json to_json(const compare::Alignment& alignment) {
  Json rotation = Json::array();
  for (Eigen::Index i = 0; i < 3; ++i) {
    rotation.push_back(to_json(Eigen::Vector3d(alignment.pose.rotation.row(i).transpose())));
  }
  return {{"reversed", alignment.reversed},
          {"arc_lengths", compare::to_string(alignment.arc_lengths)},
          {"pose",
           {{"rotation", std::move(rotation)},
            {"translation_m", to_json(alignment.pose.translation)}}}};
}

}  // namespace dlo::cli
