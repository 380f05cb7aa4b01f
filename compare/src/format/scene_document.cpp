#include "format/scene_document.hpp"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/force_model/bending.hpp"
#include "polygon/point_layout.hpp"
#include "record/field.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

Json vector_document(const Eigen::Vector3d& vector) {
  return {vector.x() + 0.0, vector.y() + 0.0, vector.z() + 0.0};  // never -0
}

Json columns_document(const Eigen::Matrix3Xd& columns) {
  Json result = Json::array();
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    result.push_back(vector_document(columns.col(i)));
  }
  return result;
}

/// Returns null for zero, which represents a quantity that is unknown, or that the rod does not
/// need.
Json known(double value) { return value > 0 ? Json(value) : Json(); }

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
                      {"natural_twist_rad_per_m",
                       section.natural_twist ? Json(*section.natural_twist) : Json()}});
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
  return {{"length_m", scene.length},
          {"diameter_m", known(scene.diameter)},
          {"inner_diameter_m", known(scene.inner_diameter)},
          {"width_m", known(scene.width)},
          {"thickness_m", known(scene.thickness)},
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
          {"mean_weight_N_per_m", vector_document(scene.weight_per_length())},
          {"natural_curvature_per_m", std::move(curvature)},
          {"natural_twist_rad_per_m", scene.natural_strain.z()},
          {"layers", layers_document(scene)},
          {"rest_shape", rest_shape_document(scene)},
          {"first_frame",
           scene.has_material_directors() ? columns_document(scene.first_frame()) : Json()},
          {"sections", sections_document(scene)}};
}

Json gripper_document(const Gripper& gripper) {
  Json frame;
  if (gripper.frame) {
    const std::optional<Eigen::Vector3d>& d1 = gripper.frame->d1;
    frame = {{"d1", d1 ? vector_document(*d1) : Json()}, {"roll_rad", gripper.frame->roll}};
  }
  return {{"at_m", gripper.at},
          {"position_m", vector_document(gripper.position)},
          {"hold", gripper.direction ? "clamp" : "pin"},
          {"direction", gripper.direction ? vector_document(*gripper.direction) : Json()},
          {"frame", std::move(frame)}};
}

/// Describes a body with the words of a scene file, from its core.
Json body_document(const obstacle::Body& body) {
  if (body.is_half_space()) {
    return {{"shape", "plane"},
            {"point_m", vector_document(body.centre() + body.radius() * body.normal())},
            {"normal", vector_document(body.normal())}};
  }
  const Eigen::Vector3d size = body.upper() - body.lower();
  Json result = {
      {"shape", "box"}, {"point_m", vector_document(body.centre())}, {"radius_m", body.radius()}};
  Eigen::Index longest = 0;
  const double length = size.maxCoeff(&longest);
  if (size.sum() > length) {
    result["axes"] = columns_document(body.axes());
    const double round = 2 * body.radius();
    result["size_m"] = vector_document(size + Eigen::Vector3d::Constant(round));
    return result;
  }
  if (length == 0) {
    result["shape"] = "sphere";
    return result;
  }
  result["shape"] = std::isfinite(length) ? "capsule" : "cylinder";
  result["axis"] = vector_document(body.axes().col(longest));
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
  result["l_s_m"] = chosen ? Json() : Json(steps.l_s);
  result["point_at_m"] = polygon.arc_length;
  result["point_mass_kg"] = point_masses(scene, settings).rod;
  result["point_force_N"] = columns_document(rod.loads);
  result["segment_m"] = std::vector<double>(rod.rest_lengths.begin(), rod.rest_lengths.end());
  result["joint_stiffness_Nm"] = joints_document(rod);
  const Eigen::VectorXd& turns = rod.bending.natural_turns;
  result["joint_turn_at_rest_rad"] = std::vector<double>(turns.begin(), turns.end());
  Json held = Json::array();
  for (const force_model::Grip& grip : rod.grips) {
    held.push_back(
        {{"first_point", grip.first_point}, {"points_m", columns_document(grip.targets)}});
  }
  result["held"] = std::move(held);
  result["start_m"] = columns_document(polygon.starts.front());
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
          {"largest_angle_rad", shape.largest_angle ? Json(*shape.largest_angle) : Json()},
          {"begin_m", vector_document(shape.begin)},
          {"first_frame", columns_document(shape.first_frame)}};
}

nlohmann::ordered_json scene_document(const Scene& scene) {
  Json grippers = Json::array();
  for (const Gripper& gripper : scene.grippers) grippers.push_back(gripper_document(gripper));
  Json loads = Json::array();
  for (const PointLoad& load : scene.loads) {
    loads.push_back({{"at_m", load.at},
                     {"force_N", vector_document(load.force)},
                     {"torque_Nm", load.torque.isZero(0) ? Json() : vector_document(load.torque)}});
    if (load.follows) loads.back()["follows"] = true;
  }
  Json distributed = Json::array();
  for (const DistributedLoad& load : scene.distributed_loads) {
    Json forces = Json::array();
    for (const Eigen::Vector3d& q : load.force_per_length) forces.push_back(vector_document(q));
    distributed.push_back(
        {{"from_m", load.from}, {"to_m", load.to}, {"force_per_length_N_per_m", forces}});
  }
  Json obstacles = Json::array();
  for (const Obstacle& obstacle : scene.obstacles) {
    obstacles.push_back(obstacle_document(obstacle));
  }
  const std::optional<Eigen::Vector3d> normal = scene.plane_normal();
  Json document = {{"schema", "dlo/scene/1"},
                   {"scene", scene.name},
                   {"file", scene.file},
                   {"gravity_m_per_s2", vector_document(scene.gravity)},
                   {"gamma", scene.gamma()},
                   {"plane_normal", normal ? vector_document(*normal) : Json()},
                   {"rod", rod_document(scene)},
                   {"grippers", std::move(grippers)},
                   {"loads", std::move(loads)},
                   {"distributed_loads", std::move(distributed)},
                   {"obstacles", std::move(obstacles)},
                   {"force_model", force_model_document(scene)}};
  if (scene.drag) {
    document["drag"] = {{"velocity_m_per_s", vector_document(scene.drag->velocity)},
                        {"normal_kg_per_m2", scene.drag->normal},
                        {"tangential_kg_per_m2", scene.drag->tangential}};
  }
  return document;
}

std::string scene_document_text(const Scene& scene) {
  return scene_document(scene).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace dlo::compare
