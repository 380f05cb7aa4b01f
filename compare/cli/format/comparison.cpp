#include "format/comparison.hpp"

#include <algorithm>
#include <cmath>

#include "base/display.hpp"
#include "base/number.hpp"
#include "dlo/compare/deviation.hpp"
#include "format/plan.hpp"
#include "format/solution.hpp"
#include "option/output.hpp"
#include "picture/budget_figure.hpp"

namespace dlo::cli {
namespace {

void add_budget(std::string& out, const compare::Comparison& comparison) {
  // A share is a part's projection on the total, so that the shares add up; a part across the total
  // has millimetres but no share.
  append(out, "  error budget    RMS, and share of the total {:.4g} mm with sign\n",
         comparison.budget.total_m * 1e3);
  for (const auto& [name, part] : compare::shown_parts(comparison)) {
    append(out, "                  {:<17}{:>9.4g} mm {:>9.2f} %\n", name,
           compare::shown(part->rms_m, comparison.length) * 1e3, part->share * 100 + 0.0);
  }
}

}  // namespace

void add_state(std::string& out, const compare::ComparedState& state, double length,
               const char* shape) {
  const std::string unstable =
      state.unstable == 0 ? "no unstable one" : fmt::format("{} unstable", state.unstable);
  append(out, "  state           {}, {:.6g} J; {}\n",
         state.only_lowest()
             ? "the only stable one found"
             : fmt::format("number {} by energy of {} stable ones found", state.rank, state.stable),
         state.energy_J,
         state.others.empty() ? "no other equilibrium found" : "besides " + unstable);
  for (const compare::OtherState& other : state.others) {
    append(out,
           "                  other: {}, {:+.4g} J, RMS {:.4g} % of l away, {:.4g} % from {}\n",
           other.stable ? "stable" : "unstable", other.energy_difference_J,
           other.rms_from_compared_m / length * 100, other.rms_from_shape_m / length * 100, shape);
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
    // Not 100 % where something is left.
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
  append(out, "  deviation       RMS {:.4g} mm = {:.4g} % of l", d.rms_m * 1e3,
         d.rms_over_length * 100);
  if (std::isfinite(d.rms_over_movement)) {
    append(out, " = {:.4g} % of the movement", d.rms_over_movement * 100);
  }
  append(out, "\n                  largest {:.4g} mm at s = {:.4f} m", d.max_m * 1e3, d.max_at_m);
  if (std::isfinite(d.tip_m)) append(out, ", tip {:.4g} mm", d.tip_m * 1e3);
  append(out, "\n");
  append(out, "                  tangent RMS {:.4g} deg, curvature RMS {:.4g} 1/m\n",
         d.angle_rms_rad * 57.29577951308232, d.curvature_rms_per_m);
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
                 {"deviation", deviation_json(comparison.deviation)},
                 {"undeformed_rms_over_length", comparison.undeformed_rms_over_length}};
  result.update(modulus_json(comparison.effective_modulus));
  result["parameters"] = parameters_json(comparison.force, comparison.settings);
  result["residual_over_movement"] = comparison.residual_over_movement;
  result["budget"] = {{"law_m", budget.law.rms_m},
                      {"bookkeeping_m", budget.bookkeeping.rms_m},
                      {"discretisation_m", budget.discretisation.rms_m},
                      {"stretch_m", budget.stretch.rms_m},
                      {"contact_m", budget.contact.rms_m},
                      {"not_at_rest_m", budget.not_at_rest.rms_m},
                      {"interaction_m", budget.interaction.rms_m},
                      {"total_m", budget.total_m},
                      {"shares_of_total",
                       {{"law", budget.law.share},
                        {"bookkeeping", budget.bookkeeping.share},
                        {"discretisation", budget.discretisation.share},
                        {"stretch", budget.stretch.share},
                        {"contact", budget.contact.share},
                        {"not_at_rest", budget.not_at_rest.share},
                        {"interaction", budget.interaction.share}}}};
  if (!comparison.force.neglected.empty()) {
    result["neglected"] = comparison.force.neglected;
    const std::pair<const char*, const compare::BudgetPart*> parts[] = {
        {"twist", &budget.twist}, {"natural curvature", &budget.natural_curvature}};
    for (const auto& [what, part] : parts) {
      if (!neglects(comparison, what)) continue;
      const std::string key = part == &budget.twist ? "twist" : "natural_curvature";
      result["budget"][key + "_m"] = part->rms_m;
      result["budget"]["shares_of_total"][key] = part->share;
    }
  }
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
  std::string text =
      "scene,law,bookkeeping,points,gamma,rms_m,max_m,tip_m,rms_over_length,rms_over_movement,"
      "effective_modulus_ratio,rms_at_effective_modulus_m,optimum,c_b,c_c,budget_twist_m,budget_"
      "natural_curvature_m,"
      "budget_law_m,budget_bookkeeping_m,budget_discretisation_m,budget_stretch_m,budget_contact_m,"
      "budget_not_at_"
      "rest_m,"
      "budget_interaction_m,budget_parts_share,residual_over_movement,state_rank,states_stable,"
      "force_steps,force_s,energy_evaluations,energy_s\n";
  for (const compare::Comparison& c : comparisons) {
    const bool has_modulus = c.effective_modulus.optimum != compare::Optimum::none;
    const std::string fields[] = {
        csv_field(c.scene),
        compare::to_string(c.settings.law),
        compare::to_string(c.settings.bookkeeping),
        std::to_string(c.settings.points),
        csv_number(c.gamma),
        csv_number(c.deviation.rms_m),
        csv_number(c.deviation.max_m),
        csv_number(c.deviation.tip_m),
        csv_number(c.deviation.rms_over_length),
        csv_number(c.deviation.rms_over_movement),
        csv_number(c.effective_modulus.ratio),
        csv_number(c.effective_modulus.rms_m),
        has_modulus ? compare::to_string(c.effective_modulus.optimum) : "",
        csv_number(c.force.parameters.c_b),
        csv_number(c.force.parameters.c_c),
        csv_number(c.budget.twist.rms_m),
        csv_number(c.budget.natural_curvature.rms_m),
        csv_number(c.budget.law.rms_m),
        csv_number(c.budget.bookkeeping.rms_m),
        csv_number(c.budget.discretisation.rms_m),
        csv_number(c.budget.stretch.rms_m),
        csv_number(c.budget.contact.rms_m),
        csv_number(c.budget.not_at_rest.rms_m),
        csv_number(c.budget.interaction.rms_m),
        csv_number(1 - c.budget.interaction.share),
        csv_number(c.residual_over_movement),
        std::to_string(c.state.rank),
        std::to_string(c.state.stable),
        std::to_string(c.force.steps),
        fmt::format("{:.4g}", c.force.seconds),
        std::to_string(c.energy_evaluations),
        fmt::format("{:.4g}", c.energy_seconds)};
    append(text, "{}\n", fmt::join(fields, ","));
  }
  return text;
}

Json comparisons_json(const std::vector<compare::Comparison>& comparisons) {
  Json cases = Json::array();
  for (const compare::Comparison& comparison : comparisons) {
    cases.push_back(comparison_json(comparison));
  }
  return {{"schema", "dlo/compare/1"}, {"cases", std::move(cases)}};
}

}  // namespace dlo::cli
