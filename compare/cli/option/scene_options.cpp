#include "option/scene_options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "dlo/compare/calibrated_rod.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene_file.hpp"
#include "option/effect.hpp"
#include "polygon/natural_plane.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::cli {

void warn_of_no_twist(const compare::Scene& scene, const std::string& study) {
  if (!compare::models_twist(scene, scene.force_model)) return;
  print_message("{}: the grippers hold twist, which {} neglects", scene.file, study);
}

void print_assumptions(const compare::Scene& scene) {
  if (!scene.model) return;
  for (const std::string& note : scene.model->notes) print_message("{}: {}", scene.file, note);
}

void warn_of_friction(const compare::Scene& scene) {
  if (!compare::is_friction_in_reach(scene)) return;
  print_message("{}: an obstacle in reach has friction, which all models neglect", scene.file);
}

void warn_of_neglected_by_polygon(const compare::Scene& scene) {
  warn_of_friction(scene);
  const std::vector<std::string> neglected =
      compare::neglected_by_polygon(scene, scene.force_model);
  const auto neglects = [&neglected](const char* what) {
    return std::find(neglected.begin(), neglected.end(), what) != neglected.end();
  };
  if (neglects("twist")) {
    print_message("{}: the grippers hold twist, which models chain and force neglect {}",
                  scene.file,
                  scene.naturally_bent() ? "of an intrinsically curved rod" : "with the law paper");
  }
  if (neglects("natural curvature")) {
    print_message("{}: the rod is intrinsically curved, which models chain and force neglect {}",
                  scene.file, scene.planar() ? "with the law paper" : "in space");
  }
}

void SceneOptions::add_to(Command& command) {
  command_ = &command.app();
  command.bind("--time", time_, "--parameters", parameters_, "--points", points_, "--law", law_,
               "--bookkeeping", bookkeeping_, "--stepper", stepper_, "--bending-rule",
               bending_rule_, "--design-curvature", design_curvature_, "--c-b", c_b_, "--c-c", c_c_,
               "--c-F", c_F_, "--c-h", c_h_, "--l-s", l_s_);
  command.bind("--terms", solve_.terms, "--max-evaluations", solve_.max_evaluations, "--time-limit",
               solve_.time_limit, "--materials", materials_, "--calibrated", calibrated_,
               "--max-steps", solve_.max_steps, "--rest-tolerance", solve_.rest_tolerance);
}

void SceneOptions::apply(compare::Scene& scene) const {
  compare::ForceModelSettings& settings = scene.force_model;
  if (!parameters_.empty()) settings = compare::load_parameters(parameters_);
  if (points_ > 0) settings.points = points_;
  const auto set = [](auto& setting, const auto& given) {
    if (given) setting = *given;
  };
  set(settings.law, law_);
  set(settings.bookkeeping, bookkeeping_);
  set(settings.stepper, stepper_);
  set(settings.bending_rule, bending_rule_);
  set(settings.design_curvature, design_curvature_);
  set(settings.c_b, c_b_);
  set(settings.c_c, c_c_);
  set(settings.c_F, c_F_);
  set(settings.c_h, c_h_);
  set(settings.l_s, l_s_);
  compare::check(settings, scene.file + ", with the command line's options");
  if (command_ != nullptr) check_effects(*command_, &settings);
}

std::vector<compare::Material> SceneOptions::materials() const {
  return materials_.empty() ? compare::materials() : compare::load_materials(materials_);
}

compare::CalibratedRod SceneOptions::calibrated() const {
  return calibrated_.empty() ? compare::CalibratedRod{} : compare::load_calibrated_rod(calibrated_);
}

compare::Scene SceneOptions::load(const std::string& path) const {
  compare::Scene scene =
      compare::calibrated_scene(compare::load_scene(path, materials()), calibrated());
  apply(scene);
  if (!time_) return scene;
  if (!compare::motion_time_span(scene)) {
    throw compare::InputError(
        fmt::format("{}: --time {:g}: nothing moves (allowed: no --time, or a scene with "
                    "[[gripper.pose]] or [[obstacle.pose]])",
                    scene.file, *time_));
  }
  return compare::scene_at(scene, *time_);
}

}  // namespace dlo::cli
