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

Json turns_json(const std::vector<compare::Linking>& parts) {
  return json_list(parts, [&](const compare::Linking& part) -> Json {
    return {{"from_m", part.begin}, {"to_m", part.end},      {"held", part.held},
            {"twist", part.twist},  {"writhe", part.writhe}, {"writhe_error", part.writhe_error}};
  });
}

/// Whether a proof or an eigenvalue decides between stable and unstable.
bool is_judged(const compare::Solution& solution) {
  return compare::is_stable(solution) || solution.status == energy_model::SolveStatus::saddle ||
         !std::isnan(solution.smallest_eigenvalue);
}

const char* stability_of(const compare::Solution& solution) {
  if (compare::is_stable(solution)) return "stable";
  if (!is_judged(solution)) return "not judged";
  return solution.status == energy_model::SolveStatus::near_singular ? "singular" : "unstable";
}

}  // namespace

Eigen::Vector3d shown(const Eigen::Vector3d& vector, double magnitude) {
  const double scale = std::max(magnitude, vector.norm());
  return {compare::shown(vector.x(), scale), compare::shown(vector.y(), scale),
          compare::shown(vector.z(), scale)};
}

std::string contact_text(const energy_model::ContactPart& contact) {
  std::string out;
  const Eigen::Vector3d force = shown(contact.force, 0);
  append(out, "obstacle {}, {}", contact.obstacle + 1, energy_model::to_string(contact.kind));
  if (contact.kind == energy_model::ContactKind::lying) {
    append(out, " from s = {:.6g} to {:.6g} m", contact.begin, contact.end);
  } else {
    append(out, " at s = {:.6g} m", contact.begin);
  }
  append(out, ": force [{:.6g}, {:.6g}, {:.6g}] N", force.x(), force.y(), force.z());
  if (contact.kind == energy_model::ContactKind::lying) {
    // Both are differences of much larger forces in the rod, so that small ones are rounding.
    constexpr double cancelled = 100;
    const double large = cancelled * force.norm();
    append(out, ", of it {:.4g} N and {:.4g} N where it begins and ends",
           compare::shown(contact.begin_force, large), compare::shown(contact.end_force, large));
  }
  return out;
}

Json contacts_json(const std::vector<energy_model::ContactPart>& contacts) {
  Json result = Json::array();
  for (const energy_model::ContactPart& contact : contacts) {
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
    result.push_back(std::move(entry));
  }
  return result;
}

/// Describes the decision on stretch = "auto".
std::string stretch_decision_text(const compare::Solution& solution) {
  switch (solution.stretch_decision) {
    case compare::StretchDecision::given:
      return "";
    case compare::StretchDecision::below_target:
      return "auto: neglected, as it would change shape and tension by less than the target";
    case compare::StretchDecision::not_modelled:
      return fmt::format("auto: neglected, though it matters: model {} has none {}",
                         compare::to_string(solution.model),
                         solution.model == compare::Model::exact
                             ? "in this scene (stretch = true says why)"
                             : "(exact has)");
    case compare::StretchDecision::counted:
      break;
  }
  const compare::StretchEffect& effect = solution.stretch;
  if (!(effect.strain > 0)) return "auto: counted, as the grips hold the rod taut";
  if (std::isnan(effect.moved_m)) {
    return fmt::format("auto: counted, as without it N/EA is up to {:.2g} %", effect.strain * 100);
  }
  return compare::formatted(
      "auto: counted, as to first order it moves the points by {:.2g} m (RMS), the largest tension "
      "by {:+.2g} %",
      effect.moved_m, effect.tension * 100);
}

namespace {

void add_work(std::string& out, const compare::Solution& solution) {
  if (solution.steps > 0) {
    append(out, "steps      {}", solution.steps);
    // Time steppers and Newton's method have neither c_F nor c_h.
    if (solution.c_F > 0) append(out, "   c_F {:.4g} m/N, c_h {:.6f}", solution.c_F, solution.c_h);
    append(out, "\n");
  } else {
    append(out, "solver     {} evaluations", solution.evaluations);
    if (solution.terms > 0) append(out, ", {} terms", solution.terms);
    append(out, "\n");
  }
}

/// Adds the effects of the scene that the model neglects.
void add_neglected(std::string& out, const compare::Solution& solution) {
  if (!solution.neglected.empty()) {
    append(out, "neglected  {}: the scene has it, model {} has not\n",
           fmt::join(solution.neglected, ", "), compare::to_string(solution.model));
  }
  if (compare::neglects(solution, "friction")) {
    append(out,
           "           (without it this is one shape; friction could hold others beside it)\n");
  }
  if (compare::neglects(solution, "stretch") && solution.stretch.strain > 0) {
    append(out, "           (N/EA is up to {:.2g} %", solution.stretch.strain * 100);
    if (std::isnan(solution.stretch.moved_m)) {
      append(out, ": what that changes is not known)\n");
    } else {
      append(out,
             ": with it the points would be {:.2g} m away (RMS), the largest tension {:+.2g} %, to "
             "first order)\n",
             solution.stretch.moved_m, solution.stretch.tension * 100);
    }
  }
}

void add_energies(std::string& out, const compare::Solution& solution,
                  const compare::Magnitudes& large) {
  compare::SceneEnergies e = solution.energy;
  for (double* part : {&e.bending, &e.twisting, &e.gravity, &e.load, &e.stretch}) {
    *part = compare::shown(*part, large.energy);
  }
  append(out, "energy     bending {:.9g} J, ", e.bending);
  if (!solution.twists.empty()) append(out, "twisting {:.9g} J, ", e.twisting);
  append(out, "gravity {:.9g} J, load {:.9g} J, stretch {:.3g} J", e.gravity, e.load, e.stretch);
  out += e.contact > 0 ? fmt::format(", contact {:.9g} J\n", e.contact) : "\n";
}

/// Whether the search followed one branch while it increased the twist of the rod.
bool follows_twist(const compare::Solution& solution) {
  return solution.model == compare::Model::energy && !solution.twists.empty();
}

void add_twists(std::string& out, const compare::Solution& solution,
                const compare::Magnitudes& large) {
  for (const energy_model::TwistedPart& part : solution.twists) {
    append(out, "twist      {:.6g} rad, torque {:.6g} Nm from s = {:.4g} to {:.4g} m\n",
           compare::shown(part.angle, 1), compare::shown(part.torque, large.torque), part.begin,
           part.end);
  }
  for (const compare::Linking& part : solution.linking) {
    const double turns = part.twist + part.writhe;
    append(out, "turns      {:.3f} = twist {:.3f} + writhe {:.3f} from s = {:.4g} to {:.4g} m",
           turns, part.twist, part.writhe, part.begin, part.end);
    constexpr double tolerance = 5e-4;  // of the printed digits
    if (std::abs(turns - part.held) > tolerance) {
      append(out, ", by the grips alone {:.3f}", part.held);
    }
    append(out, "\n");
  }
}

/// Adds the other results of the search, and what it has not tried.
void add_search(std::string& out, const compare::Solution& solution,
                const compare::Magnitudes& large) {
  const std::vector<double>& stable = solution.stable_energies;
  if (!stable.empty()) {
    append(out, "search     {} stable equilibri{} found: ", stable.size(),
           stable.size() == 1 ? "um" : "a");
    for (std::size_t i = 0; i < stable.size(); ++i) {
      append(out, "{}{:.9g} J", i == 0 ? "" : ", ", compare::shown(stable[i], large.energy));
    }
    append(out, "\n");
  }
  if (solution.passing_starts > 0) {
    append(out, "search     {} starts passed obstacles on another side\n", solution.passing_starts);
  }
  if (follows_twist(solution)) {
    append(
        out,
        "search     one branch, from the lowest shape without twist: others with these turns may "
        "be lower\n");
  }
}

/// Adds the forces of obstacles and grippers on the rod.
void add_forces(std::string& out, const compare::Solution& solution, const compare::Scene& scene,
                const compare::Magnitudes& large) {
  for (std::size_t i = 0; i < solution.obstacles.size(); ++i) {
    const Eigen::Vector3d force = shown(solution.obstacles[i], large.force);
    append(out, "obstacle {}: force [{:.6g}, {:.6g}, {:.6g}] N on the rod\n", i + 1, force.x(),
           force.y(), force.z());
  }
  for (const energy_model::ContactPart& contact : solution.contacts) {
    append(out, "contact    {}\n", contact_text(contact));
  }
  for (std::size_t i = 0; i < solution.grippers.size(); ++i) {
    const Eigen::Vector3d force = shown(solution.grippers[i].force, large.force);
    const Eigen::Vector3d torque = shown(solution.grippers[i].torque, large.torque);
    const compare::Gripper& gripper = scene.grippers[i];
    append(out,
           "gripper {} at s = {:.4g} m ({}): force [{:.6g}, {:.6g}, {:.6g}] N, torque [{:.6g}, "
           "{:.6g}, {:.6g}] Nm on the "
           "rod\n",
           i + 1, gripper.at, gripper.direction ? "clamp" : "pin", force.x(), force.y(), force.z(),
           torque.x(), torque.y(), torque.z());
  }
}

void add_points(std::string& out, const compare::Shape& shape) {
  append(out, "\n{:>12} {:>13} {:>13} {:>13}\n", "s [m]", "x [m]", "y [m]", "z [m]");
  for (std::size_t i = 0; i < shape.arc_length.size(); ++i) {
    const auto point = shape.points.col(static_cast<Eigen::Index>(i));
    append(out, "{:12.6f} {:13.8f} {:13.8f} {:13.8f}\n", shape.arc_length[i], point.x(), point.y(),
           point.z());
  }
}

}  // namespace

std::string solution_text(const compare::Solution& solution, const compare::Scene& scene) {
  std::string out;
  append(out, "scene      {}\n", compare::display(scene.name));
  append(out, "model      {}, {}\n", compare::to_string(solution.model), solution.message);
  append(out, "Gamma      {:.6g}   (w l^3 / EI)\n", scene.gamma());
  if (scene.assumes_torsion()) append(out, "assumed    {}\n", assumption_text(scene));
  if (const auto normal = scene.assumed_normal()) {
    append(out,
           "assumed    natural curvature about the normal [{:.4g}, {:.4g}, {:.4g}] of the plane of "
           "grippers, gravity and obstacles, as the first clamp has no frame\n",
           normal->x(), normal->y(), normal->z());
  }
  if (scene.layers) append(out, "layers     {}\n", layers_text(scene));
  if (scene.rest_shape) append(out, "rest shape {}\n", rest_shape_text(scene));
  add_work(out, solution);
  append(out, "wall time  {:.3g} ms\n", solution.seconds * 1e3);
  add_neglected(out, solution);
  if (const std::string decision = stretch_decision_text(solution); !decision.empty()) {
    append(out, "stretch    {}\n", decision);
  }
  if (const auto crossing = compare::self_crossing(solution.shape, scene.diameter)) {
    append(out,
           "crossing   at s = {:.4g} m and {:.4g} m the rod's axis is {:.2g} m apart, its diameter "
           "is {:g} m: contact of the rod with itself is in no model\n",
           crossing->first, crossing->second, crossing->distance, scene.diameter);
  }
  const compare::Magnitudes large = compare::magnitudes(scene);
  add_energies(out, solution, large);
  add_twists(out, solution, large);
  add_search(out, solution, large);
  add_forces(out, solution, scene, large);
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
  if (!solution.linking.empty()) result["turns"] = turns_json(solution.linking);
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
  std::string out;
  const compare::Magnitudes large = compare::magnitudes(scene);
  const std::vector<compare::Solution>& solutions = all.solutions;
  append(out, "\n{} equilibria found\n{:>16} {:>10} {:>20} {:>13} {:>13} {:>13}\n",
         solutions.size(), "energy [J]", "", "smallest eigenvalue", "x(l) [m]", "y(l) [m]",
         "z(l) [m]");
  for (const compare::Solution& solution : solutions) {
    const Eigen::Vector3d tip = shown(solution.shape.points.rightCols<1>(), large.length);
    const double eigenvalue = compare::shown(solution.smallest_eigenvalue, 1);
    append(out, "{:16.9g} {:>10} {:>20} {:13.6f} {:13.6f} {:13.6f}\n",
           compare::shown(solution.energy.total(), large.energy), stability_of(solution),
           std::isnan(eigenvalue) ? "-" : compare::formatted("{:.6g}", eigenvalue), tip.x(),
           tip.y(), tip.z());
  }
  append(out, "\nlooked from (a search: there may be others)\n{:>8} {:>12}\n", "starts",
         "found first");
  for (const energy_model::SearchStrategy& strategy : all.strategies) {
    append(out, "{:8} {:12}   {}\n", strategy.tried, strategy.found_first, strategy.name);
  }
  for (std::size_t i = 0; i < all.omitted.size(); ++i) {
    append(out, "{:<11}{}\n", i == 0 ? "not looked" : "", all.omitted[i]);
  }
  return out;
}

Json equilibria_json(const compare::AllSolutions& all, const compare::Scene& scene,
                     const compare::Plan& plan) {
  const std::vector<compare::Solution>& solutions = all.solutions;
  Json document = solution_json(solutions.front(), scene, plan);
  document["equilibria"] = json_list(solutions, [&](const compare::Solution& solution) -> Json {
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
                {"found_first", strategy.found_first}};
      });
  document["not_looked"] = all.omitted;
  return document;
}

}  // namespace dlo::cli
