#include "scene/read_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/display.hpp"
#include "base/words.hpp"
#include "dlo/compare/error.hpp"
#include "scene/read_force_model.hpp"
#include "scene/strict_table.hpp"

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
  const std::string hold = table.has("hold") ? table.choice("hold", {"clamp", "pin"}) : "clamp";
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

}  // namespace

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

}  // namespace dlo::compare
