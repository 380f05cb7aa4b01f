#include "dlo/compare/scene.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "builtin_data.hpp"
#include "dlo/compare/display.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/nearest_word.hpp"
#include "input_file.hpp"
#include "read_scene.hpp"
#include "strict_table.hpp"

namespace dlo::compare {
namespace {

/// Beyond it no solver resolves the layer at a clamp, and no rod looks any different.
constexpr double largest_gamma = 1e12;

/// Solvers of several spans take memory with the square of the number of grippers, some 250 MB for
/// the most; of the others no scene has any use for more.
constexpr std::size_t most_grippers = 500;
constexpr std::size_t most_loads = 10'000;
constexpr std::size_t most_obstacles = 1'000;

std::vector<StrictTable> bounded_tables(StrictTable& table, const char* key, std::size_t most) {
  std::vector<StrictTable> tables = table.tables(key);
  if (tables.size() > most) {
    table.fail(key, fmt::format("{} given (allowed: up to {})", tables.size(), most));
  }
  return tables;
}

template <typename Choice>
Choice choice_from(const std::string& name, const std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw InputError(
        fmt::format("unknown choice \"{}\" (allowed: {})", name, fmt::join(names, ", ")));
  }
  return static_cast<Choice>(found - names.begin());
}

Material read_material(StrictTable& rod, const std::vector<Material>& known_materials) {
  if (rod.is_table("material")) {
    StrictTable own = rod.table("material");
    Material material{.name = "own", .source = "scene file"};
    material.youngs_modulus = own.number("youngs_modulus", Dimension::pressure, Range::positive());
    material.density = own.number("density", Dimension::density, Range::not_negative());
    own.finish();
    return material;
  }
  const std::string name = rod.text("material");
  std::vector<std::string> names;
  for (const Material& material : known_materials) {
    if (material.name == name) return material;
    names.push_back(material.name);
  }
  rod.fail("material",
           fmt::format("unknown material{} (allowed: {}, or a table such as {{ youngs_modulus = "
                       "\"5 MPa\", density = 1100 }}; dlo materials lists them with values)",
                       did_you_mean(name, names), fmt::join(names, ", ")));
}

Eigen::Vector3d unit_vector(StrictTable& table, std::string_view key) {
  const Eigen::Vector3d vector = table.vector(key, Dimension::number);
  if (!(vector.norm() > 0)) table.fail(key, "must not be the zero vector");
  return vector.normalized();
}

Eigen::Vector3d read_direction(StrictTable& table) {
  if (table.is_array("direction")) return unit_vector(table, "direction");
  // A bare number is in radians; -175 is a forgotten unit.
  const Range turn{-2 * std::numbers::pi, 2 * std::numbers::pi, false,
                   "-2 pi to 2 pi rad, or a string such as \"-175 deg\", or a vector"};
  const double angle = table.number("direction", Dimension::angle, turn);
  return {std::cos(angle), std::sin(angle), 0};
}

double read_arc_length(StrictTable& table, double length) {
  return table.number("at", Dimension::length, Range::between(0, length, " m, the rod's length"));
}

/// Of numbers that are in range each on its own.
void require_finite_rod(const Scene& scene, const StrictTable& rod) {
  const auto usable = [](double stiffness) { return stiffness > 0 && std::isfinite(stiffness); };
  if (!usable(scene.bending_stiffness()) || !usable(scene.axial_stiffness())) {
    rod.fail("material",
             fmt::format("E I = {:g} N m^2, E A = {:g} N (allowed: numbers > 0 that are "
                         "finite), with diameter = {:g} m and E = {:g} Pa",
                         scene.bending_stiffness(), scene.axial_stiffness(), scene.diameter,
                         scene.material.youngs_modulus));
  }
  // The negation makes a NaN out of range.
  if (!(scene.gamma() <= largest_gamma)) {
    rod.fail("length",
             fmt::format("Gamma = w l^3 / (EI) = {:.4g} (allowed: 0 to {:g}), with w = {:.4g} N/m "
                         "and E I = {:.4g} N m^2",
                         scene.gamma(), largest_gamma, scene.weight_per_length().norm(),
                         scene.bending_stiffness()));
  }
}

Gripper read_gripper(StrictTable& table, double length) {
  Gripper gripper;
  gripper.at = read_arc_length(table, length);
  gripper.position = table.vector("position", Dimension::length);
  const std::string hold = table.optional_choice("hold", {"clamp", "pin"}).value_or("clamp");
  if (hold == "clamp") {
    gripper.direction = read_direction(table);
  } else if (table.has("direction")) {
    table.fail("direction", "a pin has no direction (allowed: hold = \"clamp\", or no direction)");
  }
  gripper.where = table.where();
  table.finish();
  return gripper;
}

Obstacle read_obstacle(StrictTable& table) {
  Obstacle obstacle;
  obstacle.point = table.vector("point", Dimension::length);
  obstacle.normal = unit_vector(table, "normal");
  obstacle.stiffness = table.optional_number("stiffness", Dimension::foundation, Range::positive())
                           .value_or(obstacle.stiffness);
  table.finish();
  return obstacle;
}

ForceModelSettings read_force_model(StrictTable& table) {
  ForceModelSettings settings;
  settings.points = table.optional_integer("points", 4, 1'000'000).value_or(settings.points);
  if (const auto name = table.optional_choice("law", law_names())) settings.law = law_from(*name);
  if (const auto name = table.optional_choice("bookkeeping", bookkeeping_names())) {
    settings.bookkeeping = bookkeeping_from(*name);
  }
  if (const auto name = table.optional_choice("stepper", stepper_names())) {
    settings.stepper = stepper_from(*name);
  }
  if (const auto name = table.optional_choice("bending_rule", bending_rule_names())) {
    settings.bending_rule = bending_rule_from(*name);
  }
  settings.design_curvature =
      table.optional_number("design_curvature", Dimension::curvature, Range::positive());
  settings.point_weight =
      table.optional_number("point_weight", Dimension::force, Range::not_negative());
  settings.c_b = table.optional_number("c_b", Dimension::force, Range::positive());
  settings.c_c = table.optional_number("c_c", Dimension::force, Range::positive());
  settings.c_F = table.optional_number("c_F", Dimension::number, Range::positive());
  settings.c_h =
      table.optional_number("c_h", Dimension::number, {0, 0.999999999, false, "0 <= c_h < 1"});
  settings.l_s = table.optional_number("l_s", Dimension::length, Range::positive());
  table.finish();
  return settings;
}

}  // namespace

const std::vector<std::string>& law_names() {
  static const std::vector<std::string> names = {"paper", "hooke"};
  return names;
}
const std::vector<std::string>& bookkeeping_names() {
  static const std::vector<std::string> names = {"paper", "consistent"};
  return names;
}
const std::vector<std::string>& stepper_names() {
  static const std::vector<std::string> names = {"basic", "limited", "relative", "dynamic", "auto"};
  return names;
}
const std::vector<std::string>& bending_rule_names() {
  static const std::vector<std::string> names = {"formula_21", "moment_matched"};
  return names;
}

Law law_from(const std::string& name) { return choice_from<Law>(name, law_names()); }
Bookkeeping bookkeeping_from(const std::string& name) {
  return choice_from<Bookkeeping>(name, bookkeeping_names());
}
StepperName stepper_from(const std::string& name) {
  return choice_from<StepperName>(name, stepper_names());
}
BendingRule bending_rule_from(const std::string& name) {
  return choice_from<BendingRule>(name, bending_rule_names());
}

const char* to_string(Law law) { return law_names()[static_cast<std::size_t>(law)].c_str(); }
const char* to_string(Bookkeeping bookkeeping) {
  return bookkeeping_names()[static_cast<std::size_t>(bookkeeping)].c_str();
}
const char* to_string(StepperName stepper) {
  return stepper_names()[static_cast<std::size_t>(stepper)].c_str();
}
const char* to_string(BendingRule rule) {
  return bending_rule_names()[static_cast<std::size_t>(rule)].c_str();
}

double Scene::cross_section() const { return std::numbers::pi * diameter * diameter / 4; }
double Scene::bending_stiffness() const {
  return material.youngs_modulus * cross_section() * diameter * diameter / 16;
}
double Scene::axial_stiffness() const { return material.youngs_modulus * cross_section(); }
double Scene::mass() const { return material.density * cross_section() * length; }
Eigen::Vector3d Scene::weight_per_length() const {
  return material.density * cross_section() * gravity;
}
double Scene::gamma() const {
  return weight_per_length().norm() * length * length * length / bending_stiffness();
}

std::optional<Eigen::Vector3d> Scene::plane_normal() const {
  std::vector<Eigen::Vector3d> vectors = {gravity};
  for (const Gripper& gripper : grippers) {
    if (gripper.direction) vectors.push_back(*gripper.direction);
    vectors.emplace_back(gripper.position - grippers.front().position);
  }
  for (const PointLoad& load : loads) vectors.push_back(load.force);
  for (const Obstacle& obstacle : obstacles) vectors.push_back(obstacle.normal);
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& v : vectors) {
    if (v.norm() > 0) moments += v.normalized() * v.normalized().transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(moments);
  if (!(axes.eigenvalues()[0] < 1e-18)) return std::nullopt;
  return Eigen::Vector3d(axes.eigenvectors().col(0));
}

int Scene::spans() const {
  int count = 1;
  for (const Gripper& gripper : grippers) {
    if (gripper.direction && gripper.at > 0 && gripper.at < length) ++count;
  }
  return count;
}

void check(const ForceModelSettings& settings, const std::string& where) {
  const auto refuse = [&](const char* key, const char* allowed) {
    throw InputError(
        fmt::format("{}: {} would have no effect (allowed: with {})", where, key, allowed));
  };
  const bool automatic = settings.stepper == StepperName::automatic;
  const bool dynamic = settings.stepper == StepperName::dynamic;
  if (settings.c_F && automatic) refuse("c_F", "a stepper other than auto, which chooses its own");
  if (settings.c_h && !dynamic) refuse("c_h", "stepper dynamic");
  if (settings.l_s && settings.stepper == StepperName::basic) {
    refuse("l_s", "a stepper other than basic");
  }
  if (settings.c_b && settings.law == Law::hooke) refuse("c_b", "law paper");
  if (settings.point_weight && settings.bookkeeping != Bookkeeping::paper) {
    refuse("point_weight", "bookkeeping paper");
  }
}

Scene read_scene(const toml::table& root, const std::string& file,
                 const std::vector<Material>& known_materials) {
  StrictTable table(root, "", file);
  Scene scene;
  scene.file = file;
  scene.name = table.optional_text("name").value_or(valid_utf8(file));
  scene.gravity = table.optional_vector("gravity", Dimension::acceleration).value_or(scene.gravity);

  if (!table.has("rod")) {
    table.fail("rod", "missing, it is required (dlo init writes a scene to start from)");
  }
  StrictTable rod = table.table("rod");
  scene.length = rod.number("length", Dimension::length, Range::between(1e-6, 1e6, " m"));
  scene.diameter = rod.number("diameter", Dimension::length, Range::between(1e-9, 1e3, " m"));
  scene.material = read_material(rod, known_materials);
  require_finite_rod(scene, rod);
  rod.finish();

  for (StrictTable& entry : bounded_tables(table, "obstacle", most_obstacles)) {
    scene.obstacles.push_back(read_obstacle(entry));
  }
  for (StrictTable& entry : bounded_tables(table, "gripper", most_grippers)) {
    scene.grippers.push_back(read_gripper(entry, scene.length));
    for (const Obstacle& obstacle : scene.obstacles) {
      if ((scene.grippers.back().position - obstacle.point).dot(obstacle.normal) >= 0) continue;
      entry.fail("position", "behind an obstacle (allowed: the side its normal points to)");
    }
  }
  if (scene.grippers.empty()) {
    throw InputError(fmt::format(
        "{}: gripper: none given, nothing would hold the rod (allowed: one or more [[gripper]])",
        file));
  }
  for (StrictTable& entry : bounded_tables(table, "load", most_loads)) {
    PointLoad load;
    load.at = read_arc_length(entry, scene.length);
    load.force = entry.vector("force", Dimension::force);
    entry.finish();
    scene.loads.push_back(load);
  }
  if (auto settings = table.optional_table("force_model")) {
    scene.force_model = read_force_model(*settings);
    check(scene.force_model, settings->where());
  }
  table.finish();
  return scene;
}

Scene parse_scene(const std::string& text, const std::string& file,
                  const std::vector<Material>& known_materials) {
  return read_scene(parse_toml(text, file), file, known_materials);
}

Scene load_scene(const std::string& path, const std::vector<Material>& known_materials) {
  return parse_scene(read_file(path), path, known_materials);
}

ForceModelSettings parse_parameters(const std::string& text, const std::string& file) {
  const toml::table root = parse_toml(text, file);
  StrictTable table(root, "", file);
  StrictTable settings_table = table.table("force_model");
  const ForceModelSettings settings = read_force_model(settings_table);
  check(settings, settings_table.where());
  (void)table.optional_table("derived");
  table.finish();
  return settings;
}

ForceModelSettings load_parameters(const std::string& path) {
  return parse_parameters(read_file(path), path);
}

std::vector<Scene> paper_scenes() {
  return {
      parse_scene(std::string(builtin::spring_steel_135_toml), "data/scenes/spring_steel_135.toml"),
      parse_scene(std::string(builtin::spring_steel_175_toml), "data/scenes/spring_steel_175.toml"),
      parse_scene(std::string(builtin::spring_steel_215_toml),
                  "data/scenes/spring_steel_215.toml")};
}

}  // namespace dlo::compare
