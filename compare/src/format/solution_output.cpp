#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/number.hpp"
#include "base/quote.hpp"
#include "base/text.hpp"
#include "dlo/compare/error.hpp"
#include "format/result_output.hpp"
#include "format/scene_document.hpp"
#include "polygon/self_crossing.hpp"
#include "record/csv_table.hpp"
#include "record/solution_fields.hpp"

namespace dlo::cli {
namespace {

Json twist_json(const std::vector<energy_model::TwistedPart>& twists) {
  double total = 0;
  Json parts = Json::array();
  for (const energy_model::TwistedPart& part : twists) {
    total += part.angle;
    parts.push_back({{"from_m", part.begin},
                     {"to_m", part.end},
                     {"angle_rad", part.angle},
                     {"torque_Nm", part.torque}});
  }
  return {{"total_rad", total}, {"parts", std::move(parts)}};
}

Json turn_json(const compare::Linking& part) {
  return {{"from_m", part.begin}, {"to_m", part.end},      {"held", part.held},
          {"twist", part.twist},  {"writhe", part.writhe}, {"writhe_error", part.writhe_error}};
}

/// Whether a proof or an eigenvalue decides between stable and unstable.
bool is_judged(const compare::Solution& solution) {
  return compare::is_stable(solution) || solution.status == energy_model::SolveStatus::saddle ||
         !std::isnan(solution.smallest_eigenvalue);
}

/// Whether the search followed one branch while it increased the twist of the rod.
bool follows_twist(const compare::Solution& solution) {
  return solution.model == compare::Model::energy && !solution.twists.empty();
}

void add_points(std::string& out, const compare::Shape& shape) {
  append(out, "\n{:>12} {:>13} {:>13} {:>13}\n", "s [m]", "x [m]", "y [m]", "z [m]");
  for (std::size_t i = 0; i < shape.arc_length.size(); ++i) {
    const auto point = shape.points.col(static_cast<Eigen::Index>(i));
    append(out, "{:12.6f} {:13.8f} {:13.8f} {:13.8f}\n", shape.arc_length[i], point.x(), point.y(),
           point.z());
  }
}

/// Adds the list of several equilibria, the start shapes of the search, and its omissions.
void add_equilibria(Json& document, const compare::AllSolutions& all) {
  document["equilibria"] = json_list(all.solutions, [&](const compare::Solution& solution) -> Json {
    return {{"stable", is_judged(solution) ? Json(compare::is_stable(solution)) : Json()},
            {"status", compare::status_name(solution.status)},
            {"smallest_eigenvalue", solution.smallest_eigenvalue},
            {"energy_J", solution.energy.total()},
            {"points_m", points_json(solution.shape.points)}};
  });
  document["looked_from"] =
      json_list(all.strategies, [&](const energy_model::SearchStrategy& strategy) -> Json {
        return {{"strategy", strategy.name},
                {"starts", strategy.tried},
                {"found_first", strategy.new_equilibria}};
      });
  document["not_looked"] = all.omitted;
}

}  // namespace

Eigen::Vector3d shown(const Eigen::Vector3d& vector, double magnitude) {
  const double scale = std::max(magnitude, vector.norm());
  return {compare::shown(vector.x(), scale), compare::shown(vector.y(), scale),
          compare::shown(vector.z(), scale)};
}

void count_from_1(Json& contacts) {
  for (Json& contact : contacts) contact["obstacle"] = contact["obstacle"].get<long>() + 1;
}

Json contacts_json(const std::vector<energy_model::ContactPart>& contacts) {
  return json_list(contacts, [](const energy_model::ContactPart& contact) {
    Json entry = {{"obstacle", contact.obstacle},
                  {"kind", energy_model::to_string(contact.kind)},
                  {"from_m", contact.begin},
                  {"to_m", contact.end},
                  {"force_N", to_json(contact.force)}};
    if (contact.kind == energy_model::ContactKind::lying) {
      entry["moment_Nm"] = to_json(contact.moment);
      entry["from_force_N"] = contact.begin_force;
      entry["to_force_N"] = contact.end_force;
      entry["largest_pressure_N_per_m"] = contact.largest_pressure;
    }
    return entry;
  });
}

std::string solution_text(const compare::Solution& solution, const compare::Scene& scene) {
  Json all = solution_json(solution, scene, {});
  if (solution.other_side_starts == 0) all.erase("passing_starts");
  if (solution.stretch_decision == compare::StretchDecision::given) all.erase("stretch_decision");
  for (const char* key : {"scene", "model", "converged", "status", "arc_length_m", "points_m",
                          "plan", "error_estimate_m"}) {
    all.erase(key);
  }
  all["solver"].erase("message");
  for (Json* part : {&all["solver"], &all["energy_J"]}) {
    for (const char* key :
         {"steps", "terms", "evaluations", "twisting", "load", "stretch", "contact"}) {
      if (part->value(key, 1.) == 0) part->erase(key);
    }
  }
  for (std::size_t i = 0; i < solution.grippers.size(); ++i) {
    all["grippers"][i]["at_m"] = scene.grippers[i].at;
    all["grippers"][i]["hold"] = scene.grippers[i].direction ? "clamp" : "pin";
  }
  if (all.contains("contacts")) count_from_1(all["contacts"]);
  if (all.contains("self_crossing")) {
    all["self_crossing"]["note"] = "contact of the rod with itself is not modelled";
  }
  if (compare::neglects(solution, "friction")) {
    all["neglected"].push_back("(this is the shape without friction; friction could hold others)");
  }
  if (follows_twist(solution)) {
    all["one_branch_followed"] =
        "from the lowest shape without twist: others with these turns may be lower";
  }
  compare::Document document{
      .json = {{"scene", scene.name},
               {"model", fmt::format("{}, {}", to_string(solution.model), solution.message)},
               {"Gamma", scene.gamma()}},
      .columns = {{"grippers", "gripper=#,at_m,hold,force_N,torque_Nm,axial_torque_Nm"},
                  {"obstacles", "obstacle=#,force_N"}},
      .large = compare::magnitudes(scene)};
  document.json.update(all);
  std::string out = document.text();
  add_points(out, solution.shape);
  return out;
}

Json solution_json(const compare::Solution& solution, const compare::Scene& scene,
                   const compare::Plan& plan) {
  const compare::SolvedShape shape{scene, solution};
  Json result = {{"schema", "dlo/solve/1"}};
  compare::add_json(result, compare::solution_fields(), shape, scene);
  result["plan"] = plan_json(plan);
  if (scene.assumes_torsion()) {
    result["assumed"] = {{"torsional_stiffness_Nm2", scene.twisting_stiffness()},
                         {"poisson_ratio", compare::assumed_poisson_ratio}};
  }
  if (const auto normal = scene.assumed_normal()) {
    result["assumed"]["natural_curvature_normal"] = {normal->x(), normal->y(), normal->z()};
  }
  if (scene.layers) result["layers"] = compare::layers_document(scene);
  if (scene.rest_shape) result["rest_shape"] = compare::rest_shape_document(scene);
  if (solution.status == energy_model::SolveStatus::near_singular &&
      solution.model == compare::Model::energy) {
    result["neutral_directions"] = solution.neutral_directions;
  }
  if (!solution.twists.empty()) result["twist"] = twist_json(solution.twists);
  if (!solution.linking.empty()) result["turns"] = json_list(solution.linking, turn_json);
  if (follows_twist(solution)) {
    result["one_branch_followed"] = true;
  }
  if (!solution.neglected.empty()) result["neglected"] = solution.neglected;
  if (!solution.obstacles.empty()) {
    result["obstacles"] = obstacles_json(solution.obstacles);
    if (solution.model == compare::Model::energy || solution.model == compare::Model::exact) {
      result["penetration_m"] = solution.penetration;
      result["contacts"] = contacts_json(solution.contacts);
    }
  }
  if (const auto crossing = compare::self_crossing(solution.shape, scene.diameter)) {
    result["self_crossing"] = {{"s_m", {crossing->first, crossing->second}},
                               {"distance_m", crossing->distance}};
  }
  if (solution.model == compare::Model::chain || solution.model == compare::Model::force) {
    result["parameters"] = parameters_json(solution, scene.force_model);
  }
  compare::add_json(result, compare::shape_numbers(), shape, scene);
  return result;
}

std::string solution_csv(const compare::Solution& solution) {
  const bool has_frame = solution.d1.cols() > 0;
  std::string text = has_frame ? "x,y,z,s,d1_x,d1_y,d1_z\n" : "x,y,z,s\n";
  for (std::size_t i = 0; i < solution.shape.arc_length.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    for (const double value : solution.shape.points.col(column)) {
      text += compare::csv_number(value, 17) + ",";
    }
    text += compare::csv_number(solution.shape.arc_length[i], 17);
    if (has_frame) {
      for (const double value : solution.d1.col(column)) {
        text += "," + compare::csv_number(value, 17);
      }
    }
    text += "\n";
  }
  return text;
}

compare::Solution numbered_equilibrium(const compare::AllSolutions& all, int number,
                                       const compare::Scene& scene) {
  const std::vector<compare::Solution>& solutions = all.solutions;
  if (number >= 1 && number <= std::ssize(solutions)) {
    return solutions[static_cast<std::size_t>(number - 1)];
  }
  throw compare::InputError(
      fmt::format("{}: equilibrium {}: the search found {} (allowed: 1 to {})", scene.file, number,
                  solutions.size(), solutions.size()));
}

std::string equilibria_text(const compare::AllSolutions& all, const compare::Scene& scene) {
  compare::Document document{
      .columns = {{"equilibria",
                   "equilibrium=#,energy_J,stable,status,smallest_eigenvalue,end_m=tip_m"}},
      .large = compare::magnitudes(scene)};
  add_equilibria(document.json, all);
  for (Json& state : document.json["equilibria"]) state["tip_m"] = state["points_m"].back();
  return fmt::format("\nequilibria found: {} (a search: there may be others)\n{}",
                     all.solutions.size(), document.text());
}

Json equilibria_json(const compare::AllSolutions& all, const compare::Scene& scene,
                     const compare::Plan& plan) {
  Json document = solution_json(all.solutions.front(), scene, plan);
  add_equilibria(document, all);
  return document;
}

}  // namespace dlo::cli
