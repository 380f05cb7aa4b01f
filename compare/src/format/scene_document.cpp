#include "format/scene_document.hpp"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/force_model/bending.hpp"
#include "format/json.hpp"
#include "polygon/point_layout.hpp"
#include "record/field.hpp"
#include "scene/members.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

Json vector_json(const Eigen::Vector3d& vector) { return to_json(vector); }

/// Returns null for zero, which represents a quantity that is unknown, or that the rod does not
/// need.
Json known(std::optional<double> value) { return value.value_or(0) != 0 ? Json(*value) : Json(); }

/// Returns a key with its SI unit, as documents have it: "mass_per_length_kg_per_m".
std::string document_key(const SceneKey& key) {
  const std::vector<std::string> units = unit_names(key.dimension);
  if (units.empty()) return key.name;
  std::string unit = units.front();
  std::erase_if(unit, [](char c) { return c == ' ' || c == '^'; });
  if (unit.starts_with("1/")) return key.name + "_per_" + unit.substr(2);
  const std::size_t over = unit.find('/');
  return key.name + "_" + (over == std::string::npos ? unit : unit.replace(over, 1, "_per_"));
}

Json stiffnesses_document(double first, const std::optional<double>& second) {
  return {first, second.value_or(first)};
}

Json sections_document(const Scene& scene) {
  Json result = Json::array();
  const energy_model::Problem problem = scene_problem(scene);
  for (std::size_t i = 0; i < scene.sections.size(); ++i) {
    const Section& section = scene.sections[i];
    result.push_back({{"from_m", section.from},
                      {"to_m", section.to},
                      {"bending_stiffness_Nm2", stiffnesses_document(section.bending_stiffness,
                                                                     section.bending_stiffness_2)},
                      {"torsional_stiffness_Nm2", known(problem.sections[i].torsional_stiffness)},
                      {"mass_per_length_kg_per_m", section.mass_per_length},
                      {"natural_curvature_per_m",
                       section.natural_curvature
                           ? Json{section.natural_curvature->x(), section.natural_curvature->y()}
                           : Json()},
                      {"natural_twist_rad_per_m", json_or_null(section.natural_twist)}});
  }
  return result;
}

Json rod_document(const Scene& scene) {
  Json curvature = Json::array();
  if (scene.naturally_curved()) {
    curvature.push_back({scene.natural_strain.x(), scene.natural_strain.y()});
    for (const Eigen::Vector2d& term : scene.natural_variation) {
      curvature.push_back({term.x(), term.y()});
    }
  }
  Json rod;
  for_each_member(scene, [&rod](const char* key, const auto& value) {
    rod[document_key(scene_table("rod").key(key))] = known(value);
  });
  rod.update(Json{
      {"inner_diameter_m", known(scene.inner_diameter)},
      {"cross_section_m2", known(scene.cross_section())},
      {"material", scene.material.name.empty() ? Json() : Json(scene.material.name)},
      {"youngs_modulus_Pa", known(scene.material.youngs_modulus)},
      {"density_kg_per_m3", known(scene.material.density)},
      {"bending_stiffness_Nm2",
       stiffnesses_document(scene.bending_stiffness(), scene.bending_stiffness_2())},
      {"torsional_stiffness_Nm2", known(scene.twisting_stiffness())},
      {"torsional_stiffness_is_assumed", scene.assumes_torsion()},
      {"assumed_torsional_stiffness_Nm2", scene.assumed_torsional_stiffness()},
      {"axial_stiffness_N", scene.axial_stiffness()},
      {"mass_per_length_kg_per_m", scene.mass_per_length()},
      {"mass_kg", scene.mass()},
      {"mean_weight_N_per_m", to_json(scene.weight_per_length())},
      {"natural_curvature_per_m", std::move(curvature)},
      {"natural_twist_rad_per_m", scene.natural_strain.z()},
      {"layers", layers_document(scene)},
      {"rest_shape", rest_shape_document(scene)},
      {"first_frame", scene.has_material_directors() ? points_json(scene.first_frame()) : Json()},
      {"sections", sections_document(scene)}});
  return rod;
}

Json gripper_document(const Gripper& gripper) {
  Json frame;
  if (gripper.frame) {
    const std::optional<Eigen::Vector3d>& d1 = gripper.frame->d1;
    frame = {{"d1", json_or_null(d1, vector_json)}, {"roll_rad", gripper.frame->roll}};
  }
  return {{"at_m", gripper.at},
          {"position_m", to_json(gripper.position)},
          {"hold", gripper.direction ? "clamp" : "pin"},
          {"direction", json_or_null(gripper.direction, vector_json)},
          {"frame", std::move(frame)}};
}

/// Describes a body with the words of a scene file, from its core.
Json body_document(const obstacle::Body& body) {
  if (body.is_half_space()) {
    return {{"shape", "plane"},
            {"point_m", to_json(body.centre() + body.radius() * body.normal())},
            {"normal", to_json(body.normal())}};
  }
  const Eigen::Vector3d size = body.upper() - body.lower();
  Json result = {
      {"shape", "box"}, {"point_m", to_json(body.centre())}, {"radius_m", body.radius()}};
  Eigen::Index longest = 0;
  const double length = size.maxCoeff(&longest);
  if (size.sum() > length) {
    result["axes"] = points_json(body.axes());
    const double round = 2 * body.radius();
    result["size_m"] = to_json(size + Eigen::Vector3d::Constant(round));
    return result;
  }
  if (length == 0) {
    result["shape"] = "sphere";
    return result;
  }
  result["shape"] = std::isfinite(length) ? "capsule" : "cylinder";
  result["axis"] = to_json(body.axes().col(longest));
  if (std::isfinite(length)) result["length_m"] = length;
  return result;
}

Json obstacle_document(const Obstacle& obstacle) {
  Json result = body_document(obstacle.body);
  const bool rigid = !std::isfinite(obstacle.stiffness);
  result["stiffness_N_per_m2"] = rigid ? Json() : Json(obstacle.stiffness);
  result["friction"] = obstacle.friction;
  return result;
}

/// Returns dM/d alpha of each joint at zero angle: EI/h; null for the paper's law, which has no
/// such stiffness.
Json joints_document(const force_model::Rod& rod) {
  if (rod.bending.law == BendingLaw::paper) return nullptr;
  Json result = Json::array();
  for (Eigen::Index i = 1; i + 1 < rod.points(); ++i) {
    const double h = (rod.rest_lengths[i - 1] + rod.rest_lengths[i]) / 2;
    result.push_back(force_model::joint_stiffness(force_model::bending_at(rod.bending, i), h, 0));
  }
  return result;
}

void add_polygon(const Scene& scene, const ForceModelSettings& settings, Json& result) {
  const Discretisation polygon = discretise(scene, settings);
  const force_model::Rod& rod = polygon.rod;
  const Parameters& parameters = polygon.parameters;
  const bool paper = settings.law == BendingLaw::paper;
  result["segment_length_m"] = parameters.segment_length;
  result["c_c"] = parameters.c_c;
  result["c_b"] = paper ? Json(parameters.c_b) : Json();
  const force_model::StepOptions steps = step_options(settings, polygon);
  const bool chosen =
      steps.policy.automatic || steps.policy.integration != force_model::Integration::along_force;
  result["c_F"] = chosen ? Json() : Json(steps.c_F);
  result["c_h"] = settings.stepper == Stepper::dynamic ? Json(steps.c_h) : Json();
  result["l_s_m"] = steps.l_s > 0 ? Json(steps.l_s) : Json();
  result["point_at_m"] = polygon.arc_length;
  const Eigen::VectorXd masses = point_masses(scene, settings).rod;
  result["point_mass_kg"] = std::vector<double>(masses.begin(), masses.end());
  result["point_force_N"] = points_json(rod.loads);
  result["segment_m"] = std::vector<double>(rod.rest_lengths.begin(), rod.rest_lengths.end());
  result["joint_stiffness_Nm"] = joints_document(rod);
  const Eigen::VectorXd& turns = rod.bending.natural_turns;
  result["joint_turn_at_rest_rad"] = std::vector<double>(turns.begin(), turns.end());
  result["held"] = json_list(rod.grips, [](const force_model::Grip& grip) -> Json {
    return {{"first_point", grip.first_point}, {"points_m", points_json(grip.targets)}};
  });
  result["start_m"] = points_json(polygon.starts.front());
}

Json force_model_document(const Scene& scene) {
  ForceModelSettings settings = scene.force_model;
  const std::optional<energy_model::JointLaw> joint_law = std::exchange(settings.joint_law, {});
  Json result = {{"points", settings.points},
                 {"law", to_string(settings.law)},
                 {"joint_law", joint_law ? Json(to_string(*joint_law)) : Json()},
                 {"bookkeeping", to_string(settings.bookkeeping)},
                 {"stepper", to_string(settings.stepper)},
                 {"refused", nullptr}};
  try {
    add_polygon(scene, settings, result);
  } catch (const InputError& error) {
    result["refused"] = error.what();
  }
  return result;
}

}  // namespace

nlohmann::ordered_json layers_document(const Scene& scene) {
  if (!scene.layers) return nullptr;
  const LayeredSection& layers = *scene.layers;
  return {{"bound", layers.bonded ? "bonded" : "free"},
          {"bonded_bending_stiffness_Nm2", layers.bonded_bending_stiffness},
          {"free_bending_stiffness_Nm2", layers.free_bending_stiffness},
          {"bonded_torsional_stiffness_Nm2", layers.bonded_torsional_stiffness},
          {"free_torsional_stiffness_Nm2", layers.free_torsional_stiffness}};
}

nlohmann::ordered_json rest_shape_document(const Scene& scene) {
  if (!scene.rest_shape) return nullptr;
  const RestShape& shape = *scene.rest_shape;
  return {{"file", shape.file},
          {"points", shape.points},
          {"arcs", shape.arcs.size()},
          {"largest_error_m", shape.largest_error},
          {"rms_error_m", shape.rms_error},
          {"largest_angle_rad", json_or_null(shape.largest_angle)},
          {"begin_m", to_json(shape.begin)},
          {"first_frame", points_json(shape.first_frame)}};
}

nlohmann::ordered_json scene_document(const Scene& scene) {
  Json loads = Json::array();
  for (const PointLoad& load : scene.loads) {
    loads.push_back({{"at_m", load.at},
                     {"force_N", to_json(load.force)},
                     {"torque_Nm", load.torque.isZero(0) ? Json() : to_json(load.torque)}});
    if (load.follows) loads.back()["follows"] = true;
  }
  Json distributed = json_list(scene.distributed_loads, [](const DistributedLoad& load) -> Json {
    return {{"from_m", load.from},
            {"to_m", load.to},
            {"force_per_length_N_per_m", json_list(load.force_per_length, vector_json)}};
  });
  Json document = {{"schema", "dlo/scene/1"},
                   {"scene", scene.name},
                   {"file", scene.file},
                   {"gravity_m_per_s2", to_json(scene.gravity)},
                   {"gamma", scene.gamma()},
                   {"plane_normal", json_or_null(scene.plane_normal(), vector_json)},
                   {"rod", rod_document(scene)},
                   {"grippers", json_list(scene.grippers, gripper_document)},
                   {"loads", std::move(loads)},
                   {"distributed_loads", std::move(distributed)},
                   {"obstacles", json_list(scene.obstacles, obstacle_document)},
                   {"force_model", force_model_document(scene)}};
  if (scene.drag) {
    document["drag"] = {{"velocity_m_per_s", to_json(scene.drag->velocity)},
                        {"normal_kg_per_m2", scene.drag->normal},
                        {"tangential_kg_per_m2", scene.drag->tangential}};
  }
  return document;
}

std::string scene_document_text(const Scene& scene) {
  return cli::json_text(scene_document(scene));
}

}  // namespace dlo::compare
