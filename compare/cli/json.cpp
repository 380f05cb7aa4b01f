#include "json.hpp"

namespace dlo::cli {

std::string json_text(const Json& document) {
  return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json modulus_json(const compare::EffectiveModulus& modulus) {
  const bool none = modulus.optimum == compare::Optimum::none;
  // NaN is null.
  return {{"effective_modulus_ratio", modulus.ratio},
          {"rms_at_effective_modulus_m", modulus.rms_m},
          {"effective_modulus_explains_share", modulus.explained_share},
          {"optimum", none ? Json() : Json(compare::to_string(modulus.optimum))},
          {"why_no_effective_modulus", none ? Json(modulus.why_none) : Json()}};
}

Json deviation_json(const compare::Deviation& deviation) {
  return {{"rms_m", deviation.rms_m},
          {"max_m", deviation.max_m},
          {"max_at_m", deviation.max_at_m},
          {"tip_m", deviation.tip_m},
          {"rms_over_length", deviation.rms_over_length},
          {"rms_over_movement", deviation.rms_over_movement},
          {"angle_rms_rad", deviation.angle_rms_rad},
          {"curvature_rms_per_m", deviation.curvature_rms_per_m}};
}

Json to_json(const compare::ComparedState& state) {
  Json others = Json::array();
  for (const compare::OtherState& other : state.others) {
    others.push_back({{"stable", other.stable},
                      {"energy_difference_J", other.energy_difference_J},
                      {"rms_from_compared_m", other.rms_from_compared_m},
                      {"rms_from_shape_m", other.rms_from_shape_m}});
  }
  return {{"energy_J", state.energy_J},
          {"rank_of_stable", state.rank},
          {"stable_found", state.stable},
          {"unstable_found", state.unstable},
          {"others", std::move(others)}};
}

Json to_json(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

Json points_json(const Eigen::Matrix3Xd& points) {
  Json result = Json::array();
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    result.push_back(to_json(Eigen::Vector3d(points.col(i))));
  }
  return result;
}

Json parameters_json(const compare::Solution& force, const compare::ForceModelSettings& settings) {
  const compare::Parameters& p = force.parameters;
  Json result = {{"points", settings.points},
                 {"law", compare::to_string(settings.law)},
                 {"bookkeeping", compare::to_string(settings.bookkeeping)},
                 {"segment_length_m", p.segment_length},
                 {"c_c", p.c_c},
                 {"point_weight_N", p.point_weight}};
  if (settings.law == compare::Law::paper) {
    result["c_b"] = p.c_b;
    if (!settings.c_b) {
      result["bending_rule"] = compare::to_string(settings.bending_rule);
      result["design_curvature_per_m"] = p.design_curvature;
    }
  }
  if (force.steps > 0) {
    result["stepper"] = compare::to_string(settings.stepper);
    result["c_F"] = force.c_F;
    result["c_h"] = force.c_h;
  }
  return result;
}

Json to_json(const compare::Plan& plan) {
  Json spans = Json::array();
  for (const compare::PlannedSpan& span : plan.spans) {
    spans.push_back({{"begin_m", span.begin},
                     {"end_m", span.end},
                     {"begin_held", span.begin_held},
                     {"end_held", span.end_held},
                     {"inner_pins", span.inner_pins}});
  }
  Json obstacles = Json::array();
  for (const compare::PlannedObstacle& obstacle : plan.obstacles) {
    obstacles.push_back({{"in_reach", obstacle.in_reach}, {"clearance_m", obstacle.clearance}});
  }
  // No bound, which is infinity, is null in JSON.
  Json left_out = Json::array();
  for (const compare::LeftOut& item : plan.left_out) {
    left_out.push_back({{"what", item.what},
                        {"by_models", item.models},
                        {"bound_m", item.bound_m},
                        {"why", item.why}});
  }
  return {{"gamma", plan.gamma},
          {"target_over_length", plan.target},
          {"geometry", plan.planar ? "planar" : "spatial"},
          {"spans", std::move(spans)},
          {"obstacles", std::move(obstacles)},
          {"stretch", plan.stretch},
          {"moving", plan.moving},
          {"contact", plan.contact},
          {"points_for_target", plan.points > 0 ? Json(plan.points) : Json()},
          {"scene_points", plan.scene_points},
          {"left_out", std::move(left_out)}};
}

namespace {

const char* status_name(energy_model::SolveStatus status) {
  switch (status) {
    case energy_model::SolveStatus::converged:
      return "converged";
    case energy_model::SolveStatus::roundoff_limited:
      return "roundoff_limited";
    case energy_model::SolveStatus::saddle:
      return "saddle";
    case energy_model::SolveStatus::near_singular:
      return "near_singular";
    case energy_model::SolveStatus::not_resolved:
      return "not_resolved";
    default:
      return "failed";
  }
}

}  // namespace

Json to_json(const compare::Solution& solution, const compare::Scene& scene,
             const compare::Plan& plan) {
  Json grippers = Json::array();
  for (const compare::GripperLoad& load : solution.grippers) {
    grippers.push_back({{"force_N", to_json(load.force)}, {"torque_Nm", to_json(load.torque)}});
  }
  const compare::SceneEnergies& energy = solution.energy;
  Json result = {{"schema", "dlo/solve/1"},
                 {"scene", scene.name},
                 {"model", compare::to_string(solution.model)},
                 {"converged", energy_model::succeeded(solution.status)},
                 {"status", status_name(solution.status)},
                 {"arc_length_m", solution.shape.arc_length},
                 {"points_m", points_json(solution.shape.points)},
                 {"energy_J",
                  {{"bending", energy.bending},
                   {"gravity", energy.gravity},
                   {"load", energy.load},
                   {"stretch", energy.stretch},
                   {"contact", energy.contact},
                   {"total", energy.total()}}},
                 {"grippers", std::move(grippers)},
                 {"solver",
                  {{"message", solution.message},
                   {"evaluations", solution.evaluations},
                   {"steps", solution.steps},
                   {"terms", solution.terms},
                   {"wall_s", solution.seconds}}},
                 {"plan", to_json(plan)}};
  if (!solution.obstacles.empty()) {
    Json obstacles = Json::array();
    for (const Eigen::Vector3d& force : solution.obstacles) {
      obstacles.push_back({{"force_N", to_json(force)}});
    }
    result["obstacles"] = std::move(obstacles);
    if (solution.model == compare::Model::energy) result["penetration_m"] = solution.penetration;
  }
  if (solution.model == compare::Model::chain || solution.model == compare::Model::force) {
    result["parameters"] = parameters_json(solution, scene.force_model);
  }
  return result;
}

Json to_json(const compare::Comparison& comparison) {
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
                      {"not_at_rest_m", budget.not_at_rest.rms_m},
                      {"interaction_m", budget.interaction.rms_m},
                      {"total_m", budget.total_m},
                      {"shares_of_total",
                       {{"law", budget.law.share},
                        {"bookkeeping", budget.bookkeeping.share},
                        {"discretisation", budget.discretisation.share},
                        {"stretch", budget.stretch.share},
                        {"not_at_rest", budget.not_at_rest.share},
                        {"interaction", budget.interaction.share}}}};
  result["reference_resolved"] = comparison.unresolved.empty();
  result["state"] = to_json(comparison.state);
  result["cost"] = {{"force_s", comparison.force.seconds},
                    {"force_steps", comparison.force.steps},
                    {"energy_s", comparison.energy_seconds},
                    {"energy_evaluations", comparison.energy_evaluations}};
  result["plan"] = to_json(comparison.plan);
  result["arc_length_m"] = comparison.force.shape.arc_length;
  result["force_points_m"] = points_json(comparison.force.shape.points);
  result["energy_points_m"] = points_json(comparison.reference.points);
  return result;
}

Json to_json(const compare::PaperReport& report) {
  Json tables = Json::array();
  for (const compare::TableRow& row : report.tables) {
    tables.push_back({{"table", row.table},
                      {"quantity", row.quantity},
                      {"unit", row.unit},
                      {"printed", row.printed},
                      {"computed", row.computed},
                      {"agrees", row.agrees},
                      {"explanation", row.explanation}});
  }
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
    Json rest = to_json(entry.rest);
    rest["point_weight"] = entry.printed_weight ? "printed" : "rho A l g / N";
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

}  // namespace dlo::cli
