#include "option/scene_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>
#include <type_traits>
#include <utility>

#include "dlo/compare/calibrated_rod.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene_file.hpp"
#include "option/effect.hpp"
#include "option/option_values.hpp"
#include "option/share.hpp"
#include "polygon/natural_plane.hpp"
#include "scene/scene_problem.hpp"
#include "toml/quantity.hpp"

namespace dlo::cli {
namespace {

using compare::Dimension;
using compare::InputError;
using Settings = compare::ForceModelSettings;

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr const char* solvers_group = "Solvers";
constexpr const char* force_model_group = "Force model (override the scene)";

/// Reads a quantity of an option: with a unit, or a number in SI units.
double option_quantity(const std::string& option, const std::string& text, Dimension dimension,
                       double below) {
  double value = 0;
  try {
    value = compare::parse_quantity(text, Dimension::number);
  } catch (const InputError&) {
    try {
      value = compare::parse_quantity(text, dimension);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{} = {}: {}", option, text, error.what()));
    }
  }
  const bool zero_allowed = below < unbounded;
  if (!(zero_allowed ? value >= 0 : value > 0) || !(value < below)) {
    throw InputError(fmt::format("{} = {}: out of range (allowed: {})", option, text,
                                 zero_allowed ? fmt::format("0 <= value < {}", below) : "> 0"));
  }
  return value;
}

}  // namespace

void warn_of_no_twist(const compare::Scene& scene, const std::string& study) {
  if (!compare::takes_twist(scene, scene.force_model)) return;
  say("{}: the grippers hold twist, which {} neglects", scene.file, study);
}

void say_assumptions(const compare::Scene& scene) {
  if (!scene.model) return;
  for (const std::string& note : scene.model->notes) say("{}: {}", scene.file, note);
}

void warn_of_friction(const compare::Scene& scene) {
  if (!compare::friction_in_reach(scene)) return;
  say("{}: an obstacle in reach has friction, which all models neglect", scene.file);
}

void warn_of_polygons(const compare::Scene& scene) {
  warn_of_friction(scene);
  const std::vector<std::string> neglected =
      compare::neglected_by_polygon(scene, scene.force_model);
  const auto neglects = [&neglected](const char* what) {
    return std::find(neglected.begin(), neglected.end(), what) != neglected.end();
  };
  if (neglects("twist")) {
    say("{}: the grippers hold twist, which models chain and force neglect {}", scene.file,
        scene.naturally_bent() ? "of an intrinsically curved rod" : "with the law paper");
  }
  if (neglects("natural curvature")) {
    say("{}: the rod is intrinsically curved, which models chain and force neglect {}", scene.file,
        scene.planar() ? "with the law paper" : "in space");
  }
}

void add_output_options(CLI::App& command, OutputOptions& options,
                        const std::vector<std::string>& formats) {
  add_checked(command, "--format", options.format, CLI::IsMember(formats),
              fmt::format("{}", fmt::join(formats, ", ")));
  add_file(command, "-o,--output", options.file,
           "write to FILE instead of standard output; its extension is the format unless --format "
           "is given");
  take_format_of_file(command, options, formats);
}

void take_format_of_file(CLI::App& command, OutputOptions& options,
                         const std::vector<std::string>& formats) {
  command.parse_complete_callback([&command, &options, formats] {
    if (command.count("--format") > 0) return;
    const std::string format = format_of_file(options.file, formats);
    if (format.empty()) return;
    options.format = format;
    command.get_option("--format")->default_str(format);
  });
}

void PlanOptions::add_to(CLI::App& command) {
  const OptionGroup group(command, "Plan");
  command.add_flag("--explain", explain_,
                   "show what the scene needs, what is neglected and what that could change");
  command
      .add_option("--target-error", plan_.target,
                  "error that the plan chooses N for, share of the length such as 0.1%")
      ->transform(share_of_length())
      ->capture_default_str();
}

void SceneOptions::add_to(CLI::App& command, Steps steps) {
  add_time_to(command);
  add_force_model_to(command);
  add_solvers_to(command, steps);
}

void SceneOptions::add_moving_to(CLI::App& command) {
  add_force_model_to(command);
  add_solvers_to(command, Steps::made);
}

void SceneOptions::add_time_to(CLI::App& command) {
  constexpr double most = 1e12;  // [s], the limit of times in files
  command
      .add_option("--time", time_,
                  "of a scene that moves: as it is at this time [s], default the first pose's")
      ->check(number_between(-most, most));
}

void SceneOptions::add_settings_to(CLI::App& command) {
  add_time_to(command);
  add_force_model_to(command);
  add_materials_to(command);
}

void SceneOptions::add_force_model_to(CLI::App& command) {
  const OptionGroup group(command, force_model_group);
  command_ = &command;
  add_file(command, "--parameters", parameters_,
           "[force_model] of a file such as dlo calibrate writes, instead of the scene's");
  command.add_option("--points", points_, "N")->check(CLI::Range(4, 1000000));
  const auto add = [this, &command](const char* name, const std::string& words, const auto& set) {
    return command.add_option_function<std::string>(
        name,
        [this, set](const std::string& text) {
          changes_.emplace_back([set, text](Settings& settings) { set(settings, text); });
        },
        words);
  };
  const auto choice = [&add](const char* name, auto field, const std::string& of_what = "") {
    using Value = std::remove_reference_t<decltype(std::declval<Settings&>().*field)>;
    add(name, of_what + compare::meanings<Value>(), [field](Settings& settings, const auto& text) {
      settings.*field = compare::from_name<Value>(text);
    })->check(CLI::IsMember(compare::names<Value>()));
  };
  const auto quantity = [&add](const char* name, std::optional<double> Settings::*field,
                               Dimension dimension, const char* words, double below = unbounded) {
    add(name, words, [=](Settings& settings, const std::string& text) {
      settings.*field = option_quantity(name, text, dimension, below);
    });
  };
  choice("--law", &Settings::law);
  choice("--bookkeeping", &Settings::bookkeeping);
  choice("--stepper", &Settings::stepper);
  choice("--bending-rule", &Settings::bending_rule, "for c_b: ");
  quantity("--design-curvature", &Settings::design_curvature, Dimension::curvature,
           "k of Formula 21 [1/m]");
  quantity("--c-b", &Settings::c_b, Dimension::force, "bending stiffness of the paper's law [N]");
  quantity("--c-c", &Settings::c_c, Dimension::force, "stretch stiffness [N], default A E");
  quantity("--c-F", &Settings::c_F, Dimension::number,
           "step factor [m/N], not for stepper auto, verlet, implicit");
  quantity("--c-h", &Settings::c_h, Dimension::number,
           "share of the last movement [-], stepper dynamic", 1);
  quantity("--l-s", &Settings::l_s, Dimension::length, "largest movement per step [m]");
}

void SceneOptions::add_solvers_to(CLI::App& command, Steps steps) {
  const OptionGroup group(command, solvers_group);
  command.add_option("--terms", solve_.terms, "curvature terms of the energy model, 0: as needed")
      ->check(CLI::Range(0, 128));
  add_checked(command, "--max-evaluations", solve_.max_evaluations, CLI::Range(1, 1000000000),
              "of the minimisers");
  add_checked(command, "--time-limit", solve_.time_limit, number_between(1e-3, 1e9),
              "of each solve [s]; if given, of the whole command too (not of sweep and regress)");
  add_materials_to(command);
  if (steps == Steps::none) return;
  add_checked(command, "--max-steps", solve_.max_steps, CLI::Range(1L, 1000000000000L),
              "of the force model");
  add_checked(command, "--rest-tolerance", solve_.rest_tolerance, number_between(1e-12, 1e-1),
              "distance from rest at which the force model stops, share of the length");
}

void SceneOptions::add_materials_to(CLI::App& command) {
  const OptionGroup group(command, solvers_group);
  add_file(command, "--materials", materials_, "materials file instead of the built-in one");
  add_file(command, "--calibrated", calibrated_,
           "what dlo calibrate -o FILE.toml wrote: its rod, how its clamps are held, and its "
           "damping in motion, in the place of the scene's");
}

void SceneOptions::apply(compare::Scene& scene) const {
  Settings& settings = scene.force_model;
  if (!parameters_.empty()) settings = compare::load_parameters(parameters_);
  if (points_ > 0) settings.points = points_;
  for (const auto& change : changes_) change(settings);
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
  if (!compare::motion_of(scene)) {
    throw InputError(
        fmt::format("{}: --time {:g}: nothing moves (allowed: no --time, or a scene with "
                    "[[gripper.pose]] or [[obstacle.pose]])",
                    scene.file, *time_));
  }
  return compare::scene_at(scene, *time_);
}

}  // namespace dlo::cli
