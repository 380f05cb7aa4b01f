#include "record/solution_fields.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

Json grippers_json(const SolvedShape& shape) {
  Json grippers = Json::array();
  for (std::size_t i = 0; i < shape.solution.grippers.size(); ++i) {
    const GripperLoad& load = shape.solution.grippers[i];
    const Gripper& gripper = shape.scene.grippers[i];
    Json entry = {{"force_N", to_json(load.force)}, {"torque_Nm", to_json(load.torque)}};
    if (gripper.frame && gripper.direction && !neglects(shape.solution, "twist") &&
        !neglects(shape.solution, "natural curvature")) {
      entry["axial_torque_Nm"] = load.torque.dot(*gripper.direction);
    }
    grippers.push_back(std::move(entry));
  }
  return grippers;
}

/// Returns the sum over Solution::linking; NaN if that is empty or lacks an interval, whose turns
/// are then undetermined.
double turns(const SolvedShape& shape, double Linking::*of_part) {
  const std::size_t found = shape.solution.linking.size();
  if (found == 0 || found < shape.solution.twists.size())
    return std::numeric_limits<double>::quiet_NaN();
  double sum = 0;
  for (const Linking& part : shape.solution.linking) sum += part.*of_part;
  return sum;
}

bool prescribes_twist(const Scene& scene) { return scene.prescribes_twist(); }

}  // namespace

std::span<const Field<SolvedShape>> solution_fields() {
  using S = const SolvedShape&;
  constexpr unsigned document = in_json | in_python;
  static const Field<SolvedShape> fields[] = {
      {"scene", "", "The scene's name", [](S s) { return s.scene.name; }, document},
      {"model", "", "\"energy\", \"chain\", \"exact\" or \"force\"",
       [](S s) -> std::string { return to_string(s.solution.model); }, document},
      {"converged", "", "Whether the shape is an equilibrium that is proven stable",
       [](S s) { return energy_model::succeeded(s.solution.status); }, document},
      {"status", "",
       "\"converged\", \"roundoff_limited\", \"saddle\", \"near_singular\" or \"not_verified\"",
       [](S s) -> std::string { return status_name(s.solution.status); }, document},
      {"arc_length", "m", "Arc lengths of the points",
       [](S s) -> Json { return s.solution.shape.arc_length; }, in_json},
      {"points", "m", "Positions", [](S s) { return points_json(s.solution.shape.points); },
       in_json},
      {"energy", "J", "Energies: bending, twisting, gravity, load, stretch, contact, total",
       [](S s) { return numbers_of(energy_fields(), s.solution.energy); }, document},
      {"grippers", "", "Force and torque of each gripper on the rod", grippers_json, in_json},
      {"message", "", "Outcome of the solver", [](S s) { return s.solution.message; }, document,
       "solver/message"},
      {"evaluations", "", "Evaluations of the minimiser, or shots of exact",
       [](S s) { return s.solution.evaluations; }, document, "solver/evaluations"},
      {"steps", "", "Steps of the force model", [](S s) { return s.solution.steps; }, document,
       "solver/steps"},
      {"terms", "", "Curvature coefficients of the energy model",
       [](S s) -> long { return s.solution.terms; }, document, "solver/terms"},
      {"seconds", "", "Wall time of the solver [s]", [](S s) { return s.solution.seconds; },
       document, "solver/wall_s"},
      {"smallest_eigenvalue", "",
       "Smallest eigenvalue of the reduced Hessian over EI/l, < 0 if unstable; none: not known",
       [](S s) { return s.solution.smallest_eigenvalue; }, document},
      {"stable_energies", "J",
       "Energies of the stable equilibria that the search found, lowest first; none: no search",
       [](S s) { return s.solution.stable_energies; }, document},
      {"passing_starts", "", "Number of initial guesses that pass obstacles on another side",
       [](S s) -> long { return s.solution.other_side_starts; }, document},
      {"stable", "", "Whether it is stable, as far as that is known",
       [](S s) { return is_stable(s.solution); }, in_python},
      {"error_estimate", "m", "Estimated largest error of the points; none: not known",
       [](S s) { return s.solution.error_estimate; }, document},
      {"neglected", "", "Properties of the scene that the model neglects",
       [](S s) { return s.solution.neglected; }, in_python},
      {"stretch_strain", "",
       "Largest axial strain N/EA of a shape solved without stretch; none: EA is not known, or it "
       "is too small to matter",
       [](S s) { return s.solution.stretch.strain; }, document},
      {"stretch_moves", "m", "RMS displacement of the points by stretch, to first order",
       [](S s) { return s.solution.stretch.displacement_m; }, document},
      {"stretch_tension_change", "", "Relative change of the largest tension by stretch",
       [](S s) { return s.solution.stretch.tension; }, document},
      {"stretch_decision", "",
       "Decision on stretch = \"auto\": \"counted\", \"below_target\" or \"not_modelled\"; for "
       "other rods \"given\"",
       [](S s) -> std::string { return to_string(s.solution.stretch_decision); }, document}};
  return fields;
}

std::span<const Field<SolvedShape>> shape_numbers() {
  using S = const SolvedShape&;
  static const Field<SolvedShape> fields[] = {
      {"link", "turns", "Turns of the rod's frames: twist and writhe",
       [](S s) { return turns(s, &Linking::twist) + turns(s, &Linking::writhe); }, everywhere, "",
       prescribes_twist},
      {"twist", "turns", "Twist of the rod about its axis, a part of the link",
       [](S s) { return turns(s, &Linking::twist); }, everywhere, "", prescribes_twist},
      {"writhe", "turns", "Writhe of the axis, a part of the link",
       [](S s) { return turns(s, &Linking::writhe); }, everywhere, "", prescribes_twist}};
  return fields;
}

std::span<const Field<SceneEnergies>> energy_fields() {
  using E = const SceneEnergies&;
  static const Field<SceneEnergies> fields[] = {
      {"bending", "", "Bending energy of joints or curvature", [](E e) { return e.bending; }},
      {"twisting", "", "Twisting energy between held frames", [](E e) { return e.twisting; }},
      {"gravity", "", "Potential of the rod's weight", [](E e) { return e.gravity; }},
      {"load", "", "Potential of loads, at points and per length", [](E e) { return e.load; }},
      {"stretch", "", "Stretching energy of the rod or of segments", [](E e) { return e.stretch; }},
      {"contact", "", "Energy of obstacles that yield", [](E e) { return e.contact; }},
      {"total", "", "Sum of all energies", [](E e) { return e.total(); }}};
  return fields;
}

std::span<const Field<Deviation>> deviation_fields() {
  using D = const Deviation&;
  static const Field<Deviation> fields[] = {
      {"rms", "m", "RMS distance", [](D d) { return d.rms_m; }},
      {"max", "m", "Largest distance of a point", [](D d) { return d.max_m; }},
      {"max_at", "m", "Arc length of that point", [](D d) { return d.max_at_m; }},
      {"tip", "m", "Distance at the free end; NaN without a free end", [](D d) { return d.tip_m; }},
      {"rms_over_length", "", "RMS distance over the rod's length",
       [](D d) { return d.rms_over_length; }},
      {"rms_over_movement", "", "RMS distance over RMS displacement from straight; NaN without one",
       [](D d) { return d.rms_over_movement; }},
      {"angle_rms", "rad", "RMS angle between the tangents", [](D d) { return d.angle_rms_rad; }},
      {"curvature_rms", "per_m", "RMS difference of the curvatures",
       [](D d) { return d.curvature_rms_per_m; }}};
  return fields;
}

const char* status_name(energy_model::SolveStatus status) {
  using Status = energy_model::SolveStatus;
  constexpr std::pair<Status, const char*> names[] = {
      {Status::converged, "converged"},
      {Status::roundoff_limited, "roundoff_limited"},
      {Status::saddle, "saddle"},
      {Status::near_singular, "near_singular"},
      {Status::not_verified, "not_verified"}};
  for (const auto& [known, name] : names) {
    if (known == status) return name;
  }
  return "failed";
}

bool is_stable(const Solution& solution) {
  return energy_model::succeeded(solution.status) ||
         (solution.status == energy_model::SolveStatus::not_verified &&
          solution.smallest_eigenvalue >= 0);
}

bool is_balance_alone(const Scene& scene, const Solution& solution) {
  return solution.status == energy_model::SolveStatus::not_verified &&
         !energy_model::has_potential(scene_problem(scene));
}

bool neglects(const Solution& solution, std::string_view what) {
  return std::ranges::find(solution.neglected, what) != solution.neglected.end();
}

}  // namespace dlo::compare
