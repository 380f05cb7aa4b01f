#include "scene/read_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "base/display.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/energy_model/turns.hpp"
#include "scene/read_force_model.hpp"
#include "scene/read_rod.hpp"
#include "scene/scene_problem.hpp"
#include "toml/scene_keys.hpp"
#include "toml/strict_table.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

/// Solvers of several spans take memory with the square of the number of grippers, some 250 MB for
/// the most; of the others no scene has any use for more.
constexpr std::size_t most_grippers = 500;
constexpr std::size_t most_loads = 10'000;
constexpr std::size_t most_distributed_loads = 100;
constexpr std::size_t most_forces_per_length = 100;
constexpr std::size_t most_sections = 1'000;
constexpr std::size_t most_obstacles = 1'000;

std::vector<StrictTable> bounded_tables(StrictTable& table, const char* key, std::size_t most) {
  std::vector<StrictTable> tables = table.tables(key);
  if (tables.size() > most) {
    table.fail(key, fmt::format("{} given (allowed: up to {})", tables.size(), most));
  }
  return tables;
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

/// What six decimals leave of a rotation matrix or a quaternion.
constexpr double rotation_tolerance = 2e-6;
constexpr int most_turns = 1000;
constexpr const char* frame_keys[] = {"roll", "frame", "quaternion", "turns"};

/// Columns d1, d2, d3 of a clamp that has them in the file.
std::optional<Eigen::Matrix3d> read_directors(StrictTable& table) {
  const std::optional<Eigen::Matrix3d> rows = table.optional_rows("frame");
  const std::optional<Eigen::Quaterniond> quaternion = table.optional_quaternion("quaternion");
  if (quaternion) {
    if (!(std::abs(quaternion->norm() - 1) <= rotation_tolerance)) {
      table.fail("quaternion", fmt::format("has the norm {:.7g} (allowed: 1 within {:g})",
                                           quaternion->norm(), rotation_tolerance));
    }
    return quaternion->normalized().toRotationMatrix();
  }
  if (!rows) return std::nullopt;
  const Eigen::Matrix3d off = *rows * rows->transpose() - Eigen::Matrix3d::Identity();
  if (!(off.cwiseAbs().maxCoeff() <= rotation_tolerance)) {
    table.fail("frame", fmt::format("rows d1, d2, d3 are off by {:.2g} from unit length or right "
                                    "angles (allowed: up to {:g})",
                                    off.cwiseAbs().maxCoeff(), rotation_tolerance));
  }
  if (rows->determinant() < 0) table.fail("frame", "is left-handed (allowed: d3 = d1 x d2)");
  return rows->transpose();
}

/// Direction and frame of a clamp: the frame is a roll, or three directors, and there may be none.
/// The first of its poses has a direction and a roll where they have some.
void read_clamp(StrictTable& table, Gripper& gripper) {
  const Pose first = gripper.trajectory.empty() ? Pose() : gripper.trajectory.poses().front();
  const std::optional<Eigen::Vector3d>& moving_direction = first.direction;
  for (const char* key : {"direction", "frame", "quaternion"}) {
    if (!moving_direction || !table.has(key)) continue;
    table.fail(key, fmt::format("given besides poses with directions (allowed: poses without "
                                "directions, or no {})",
                                key));
  }
  const char* given = nullptr;
  for (const char* key : {"roll", "frame", "quaternion"}) {
    if (!table.has(key)) continue;
    if (given != nullptr) {
      table.fail(
          key, fmt::format("given besides {} (allowed: one of roll, frame and quaternion)", given));
    }
    given = key;
  }
  const std::optional<double> roll = table.optional_number("roll", Dimension::angle, Range::any());
  const std::optional<Eigen::Matrix3d> directors = read_directors(table);
  const std::optional<int> turns = table.optional_integer("turns", -most_turns, most_turns);
  if (turns && !directors) {
    table.fail("turns", "needs frame or quaternion (allowed: a roll of any size, \"720 deg\")");
  }
  if (roll && first.roll) {
    table.fail("roll", "given besides poses with rolls (allowed: poses without, or no roll)");
  }
  if (roll || first.roll) {
    gripper.frame = FrameHold{.d1 = std::nullopt, .roll = roll ? *roll : *first.roll};
  }
  const Eigen::Vector3d d3 = directors ? directors->col(2).normalized() : Eigen::Vector3d::Zero();
  const Eigen::Vector3d direction = moving_direction                       ? *moving_direction
                                    : directors && !table.has("direction") ? d3
                                                                           : read_direction(table);
  gripper.direction = direction;
  if (!directors) return;
  if (!((direction - d3).norm() <= rotation_tolerance)) {
    table.fail("direction", fmt::format("is not d3 = [{:.6g}, {:.6g}, {:.6g}] of {} (allowed: the "
                                        "same, or none)",
                                        d3.x(), d3.y(), d3.z(), given));
  }
  const Eigen::Vector3d d1 = directors->col(0);
  gripper.frame =
      FrameHold{.d1 = (d1 - d1.dot(direction) * direction).normalized(),
                .roll = 2 * std::numbers::pi * turns.value_or(0) + first.roll.value_or(0)};
}

/// Where something is whose poses, if it has any, say so too: the first of them is where it is.
Eigen::Vector3d read_place(StrictTable& table, const char* key, const Trajectory& trajectory) {
  if (trajectory.empty()) return table.vector(key, Dimension::length);
  if (table.has(key)) {
    table.fail(key,
               fmt::format("given besides poses, which say where it is (allowed: no {})", key));
  }
  return trajectory.poses().front().position;
}

Gripper read_gripper(StrictTable& table, double length, const std::string& file) {
  Gripper gripper;
  table.only(scene_keys("gripper"));
  gripper.at = read_arc_length(table, "at", length);
  const std::string hold = table.has("hold") ? table.choice("hold", {"clamp", "pin"}) : "clamp";
  PoseKeys keys;
  if (hold == "clamp") keys.direction = read_direction;
  gripper.trajectory = read_trajectory(table, keys, file);
  gripper.position = read_place(table, "position", gripper.trajectory);
  if (hold == "clamp") {
    read_clamp(table, gripper);
  } else {
    if (table.has("direction")) {
      table.fail("direction",
                 "a pin has no direction (allowed: hold = \"clamp\", or no direction)");
    }
    for (const char* key : frame_keys) {
      if (!table.has(key)) continue;
      table.fail(key,
                 fmt::format("a pin holds no frame (allowed: hold = \"clamp\", or no {})", key));
    }
  }
  gripper.where = table.where();
  table.finish();
  return gripper;
}

/// What clamps that hold frames need.
void check_twist(const Scene& scene, const StrictTable& rod) {
  if (!scene.holds_twist()) return;
  if (!scene.torsional_stiffness && !scene.assumes_torsion()) {
    rod.fail("torsional_stiffness",
             fmt::format(
                 "missing, it is required where two clamps hold the rod's frame (allowed: "
                 "> 0; of {}, here {:.3g} N m^2 with nu = 0.3)",
                 scene.width > 0 ? "a rectangle E J / (2 (1 + nu))" : "a round rod EI / (1 + nu)",
                 scene.assumed_torsional_stiffness()));
  }
}

/// Which way a rod is intrinsically curved, and where its principal axes are, has to be said by a
/// clamp.
/// @param sections  the tables of its sections
void check_material_directors(const Scene& scene, const StrictTable& rod,
                              const std::vector<StrictTable>& sections) {
  const bool clamped =
      std::any_of(scene.grippers.begin(), scene.grippers.end(),
                  [](const Gripper& gripper) { return gripper.direction.has_value(); });
  constexpr const char* unheld =
      "no gripper holds the rod's frame (allowed: a gripper with hold = \"clamp\")";
  for (const char* key : {"natural_curvature", "natural_twist", "helix", "rest_shape"}) {
    if (!clamped && rod.has(key)) rod.fail(key, unheld);
    for (const StrictTable& section : sections) {
      if (!clamped && section.has(key)) section.fail(key, unheld);
    }
  }
  if (!clamped && scene.has_two_stiffnesses()) {
    rod.fail(rod.has("width") ? "width" : "bending_stiffness", unheld);
  }
  (void)scene.natural_curvature();
  if (scene.has_two_stiffnesses()) (void)scene.first_frame();
}

/// That the grips alone say where each roll counts from.
/// @param entries  the grippers' tables, in the scene's order
void check_rolls(const Scene& scene, const std::vector<StrictTable>& entries) {
  if (!scene.holds_twist()) return;
  if (scene.has_material_directors()) (void)scene.first_frame();
  const energy_model::Problem problem = scene_problem(scene);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const energy_model::Grip& grip = problem.grips[i];
    if (!grip.frame || grip.frame->d1) continue;
    try {
      (void)energy_model::held_d1(problem, grip);
    } catch (const std::invalid_argument&) {
      entries[i].fail("roll",
                      "leaves open where it counts from: the direction is opposite to the first "
                      "clamp's and in line with it (allowed: frame or quaternion)");
    }
  }
}

/// What has no potential, and couples, act on a rod that touches nothing; what follows it, where no
/// clamp holds it.
/// @param entries  the loads' tables, in the scene's order
void check_turning_loads(const Scene& scene, const std::vector<StrictTable>& entries) {
  constexpr double at_clamp = 1e-9;  // of the length, as energy_model has it
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const PointLoad& load = scene.loads[i];
    if (load.torque.isZero(0) && !load.follows) continue;
    if (!scene.obstacles.empty()) {
      entries[i].fail(load.follows ? "follows" : "torque",
                      "beside obstacles, with which no model takes it (allowed: no obstacles, or "
                      "forces that keep their direction)");
    }
    if (!load.follows) continue;
    const auto clamped = [&](const Gripper& gripper) {
      return gripper.direction && std::abs(gripper.at - load.at) <= at_clamp * scene.length;
    };
    if (std::any_of(scene.grippers.begin(), scene.grippers.end(), clamped)) {
      entries[i].fail("follows",
                      "at a clamp, which would hold it (allowed: true where no clamp is)");
    }
  }
}

/// Edges of a box: `size` along `axis`, along `normal` and across both.
obstacle::Body read_box(StrictTable& table, const Eigen::Vector3d& centre) {
  const Eigen::Vector3d size = table.vector("size", Dimension::length);
  if (!(size.minCoeff() > 0)) table.fail("size", "has to be three lengths > 0");
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  if (table.has("axis")) axes.col(0) = unit_vector(table, "axis");
  if (table.has("normal")) axes.col(1) = unit_vector(table, "normal");
  constexpr double square = 1e-6;
  if (std::abs(axes.col(0).dot(axes.col(1))) > square) {
    table.fail(table.has("axis") ? "axis" : "normal",
               "the edges along axis and normal are not at right angles (axis is +x and normal +y "
               "if not given)");
  }
  axes.col(1) = (axes.col(1) - axes.col(1).dot(axes.col(0)) * axes.col(0)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  const double largest = size.minCoeff() / 2;
  const Range round{0, largest, false,
                    fmt::format("0 to half of the smallest size, {:.4g} m", largest)};
  const double radius = table.optional_number("radius", Dimension::length, round).value_or(0);
  return obstacle::Body::box(centre, axes, size, radius);
}

Obstacle read_obstacle(StrictTable& table, const Scene& scene, const std::string& file) {
  Obstacle obstacle;
  table.only(scene_keys("obstacle"));
  obstacle.trajectory = read_trajectory(table, {.position = "point", .direction = nullptr}, file);
  const Eigen::Vector3d point = read_place(table, "point", obstacle.trajectory);
  const std::string shape =
      table.has("shape") ? table.choice("shape", {"plane", "sphere", "cylinder", "capsule", "box"})
                         : "plane";
  const auto length_of = [&table](const char* key) {
    return table.number(key, Dimension::length, Range::positive());
  };
  if (shape == "plane") {
    obstacle.body = obstacle::Body::half_space(point, unit_vector(table, "normal"));
  } else if (shape == "sphere") {
    obstacle.body = obstacle::Body::sphere(point, length_of("radius"));
  } else if (shape == "cylinder") {
    obstacle.body =
        obstacle::Body::cylinder(point, unit_vector(table, "axis"), length_of("radius"));
  } else if (shape == "capsule") {
    obstacle.body = obstacle::Body::capsule(point, unit_vector(table, "axis"), length_of("length"),
                                            length_of("radius"));
  } else {
    obstacle.body = read_box(table, point);
  }
  obstacle.stiffness = table.optional_number("stiffness", Dimension::foundation, Range::positive())
                           .value_or(obstacle.stiffness);
  obstacle.friction = table.optional_number("friction", Dimension::number, Range::not_negative())
                          .value_or(obstacle.friction);
  const bool axis = table.has("touches") && table.choice("touches", {"surface", "axis"}) == "axis";
  if (!axis && scene.width > 0) {
    table.fail("touches",
               "missing or \"surface\", which is not at one distance from the axis of a rod with "
               "width and thickness (allowed: touches = \"axis\")");
  }
  if (!axis) obstacle.body = obstacle.body.grown(scene.diameter / 2);
  if (!(obstacle.body.smallest_radius() > 0)) {
    table.fail(axis ? "touches" : "size",
               "a box whose edges are sharp, over which the rod would bend without a radius "
               "(allowed: radius > 0, which rounds its edges, or the surface of a rod with a "
               "diameter)");
  }
  table.finish();
  return obstacle;
}

/// The gripper that was read last has to be on the free side of every obstacle.
void require_clear(const Scene& scene, const StrictTable& entry) {
  for (const Obstacle& obstacle : scene.obstacles) {
    const double height = obstacle.body.clearance(scene.grippers.back().position);
    const double rounding = 1e-12 * scene.length;
    if (height >= -rounding) continue;
    const double radius = scene.diameter / 2;
    if (height < -radius - rounding) {
      entry.fail("position", obstacle.body.is_half_space()
                                 ? "behind an obstacle (allowed: the side its normal points to)"
                                 : "within an obstacle (allowed: outside of it)");
    }
    entry.fail("position",
               fmt::format("{:.4g} m from an obstacle, which the rod would enter with its surface "
                           "(allowed: its radius, {:.4g} m, or more; or touches = \"axis\" in the "
                           "[[obstacle]])",
                           std::abs(height + radius) < rounding ? 0 : height + radius, radius));
  }
}

PointLoad read_load(StrictTable& table, const Scene& scene) {
  PointLoad load;
  table.only(scene_keys("load"));
  load.at = read_arc_length(table, "at", scene.length);
  const std::optional<double> mass =
      table.optional_number("mass", Dimension::mass, Range::positive());
  if (mass && table.has("force")) {
    table.fail("mass", "given besides force (allowed: one of force and mass)");
  }
  load.torque = table.optional_vector("torque", Dimension::torque).value_or(load.torque);
  load.follows = table.flag("follows");
  if (mass && load.follows) {
    table.fail("follows", "of a mass, which hangs along gravity (allowed: force and torque)");
  }
  if (mass) {
    load.force = *mass * scene.gravity;
  } else if (!table.has("torque") || table.has("force")) {
    if (!table.has("force")) {
      table.fail("force",
                 "missing, and so are mass and torque (allowed: force or mass, torque, or one of "
                 "the two with torque)");
    }
    load.force = table.vector("force", Dimension::force);
  }
  load.mass = mass.value_or(0);
  table.finish();
  return load;
}

DistributedLoad read_distributed_load(StrictTable& table, const Scene& scene) {
  DistributedLoad load{0, scene.length, {}};
  table.only(scene_keys("distributed_load"));
  if (table.has("from")) load.from = read_arc_length(table, "from", scene.length);
  if (table.has("to")) load.to = read_arc_length(table, "to", scene.length);
  if (!(load.to > load.from)) {
    table.fail(
        table.has("to") ? "to" : "from",
        fmt::format("the load ends at {:g} m, where it begins or before (allowed: to > from, "
                    "which are 0 and the rod's length if not given)",
                    load.to));
  }
  load.force_per_length =
      table.vectors("force_per_length", Dimension::force_per_length, most_forces_per_length);
  table.finish();
  return load;
}

/// What drags the rod, by Morison's law on its diameter.
std::optional<energy_model::Drag> read_drag(StrictTable& table, double density, double diameter) {
  if (!table.has("velocity")) {
    for (const char* key : {"normal_drag", "tangential_drag"}) {
      if (!table.has(key)) continue;
      table.fail(key, fmt::format("of a medium at rest (allowed: velocity too, or no {})", key));
    }
    return std::nullopt;
  }
  energy_model::Drag drag;
  drag.velocity = table.vector("velocity", Dimension::velocity);
  const double unit = density * diameter / 2;
  drag.normal = unit * table.number("normal_drag", Dimension::number, Range::not_negative());
  drag.tangential =
      std::numbers::pi * unit *
      table.optional_number("tangential_drag", Dimension::number, Range::not_negative())
          .value_or(0);
  if (drag.velocity.isZero(0)) return std::nullopt;
  return drag;
}

/// What the rod displaces bears it: a load against gravity, of a mass that does not move.
void read_medium(StrictTable& table, Scene& scene) {
  table.only(scene_keys("medium"));
  const double density = table.number("density", Dimension::density, Range::positive());
  if (!(scene.diameter > 0)) {
    table.fail("density",
               "of a rod whose volume is not known (allowed: [rod] with diameter, or no [medium])");
  }
  scene.drag = read_drag(table, density, scene.diameter);
  if (scene.drag && !scene.obstacles.empty()) {
    table.fail(
        "velocity",
        "beside obstacles, with which no model takes drag (allowed: neither, or no velocity)");
  }
  table.finish();
  const double section = std::numbers::pi * scene.diameter * scene.diameter / 4;
  scene.distributed_loads.push_back({0, scene.length, {-density * section * scene.gravity}});
}

}  // namespace

Scene read_scene(const toml::table& root, const std::string& file,
                 const std::vector<Material>& known_materials) {
  StrictTable table(root, "", file);
  table.only(scene_keys(""));
  Scene scene;
  scene.file = file;
  scene.name = table.optional_text("name").value_or(valid_utf8(file));
  scene.gravity = table.optional_vector("gravity", Dimension::acceleration).value_or(scene.gravity);

  if (!table.has("rod")) {
    table.fail("rod", "missing, it is required (dlo init writes a scene to start from)");
  }
  StrictTable rod = table.table("rod");
  std::vector<StrictTable> sections = bounded_tables(table, "section", most_sections);
  read_rod(rod, sections, known_materials, scene);

  for (StrictTable& entry : bounded_tables(table, "obstacle", most_obstacles)) {
    scene.obstacles.push_back(read_obstacle(entry, scene, file));
  }
  std::vector<StrictTable> grippers = bounded_tables(table, "gripper", most_grippers);
  for (StrictTable& entry : grippers) {
    scene.grippers.push_back(read_gripper(entry, scene.length, file));
    require_clear(scene, entry);
  }
  if (scene.grippers.empty()) {
    throw InputError(fmt::format(
        "{}: gripper: none given, nothing would hold the rod (allowed: one or more [[gripper]])",
        file));
  }
  check_twist(scene, rod);
  std::vector<StrictTable> loads = bounded_tables(table, "load", most_loads);
  for (StrictTable& entry : loads) scene.loads.push_back(read_load(entry, scene));
  for (StrictTable& entry : bounded_tables(table, "distributed_load", most_distributed_loads)) {
    scene.distributed_loads.push_back(read_distributed_load(entry, scene));
  }
  if (auto medium = table.optional_table("medium")) {
    read_medium(*medium, scene);
  }
  check_material_directors(scene, rod, sections);
  check_turning_loads(scene, loads);
  check_rolls(scene, grippers);
  if (auto settings = table.optional_table("force_model")) {
    scene.force_model = read_force_model(*settings);
    check(scene.force_model, settings->where());
  }
  if (auto rates = table.optional_table("track")) {
    rates->only(scene_keys("track"));
    const auto rate = [&rates](const char* key) {
      return rates->optional_number(key, Dimension::frequency, Range::positive());
    };
    scene.track.frames = rate("frame_rate").value_or(scene.track.frames);
    scene.track.obstacles = rate("obstacle_rate");
    scene.track.steps = rate("step_rate").value_or(scene.track.steps);
    rates->finish();
  }
  table.finish();
  return scene;
}

}  // namespace dlo::compare
