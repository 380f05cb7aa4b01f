#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/turns.hpp"
#include "reading/read_parts.hpp"
#include "scene/scene_problem.hpp"
#include "toml/strict_table.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

Eigen::Vector3d read_direction(StrictTable& table) {
  if (table.is("direction", toml::node_type::array)) return unit_vector(table, "direction");
  // A bare number is in radians. The range refuses -175, which is meant in degrees.
  const Range turn{-2 * std::numbers::pi, 2 * std::numbers::pi, false,
                   "-2 pi to 2 pi rad, or a string such as \"-175 deg\", or a vector"};
  const double angle = table.number("direction", Dimension::angle, turn);
  return {std::cos(angle), std::sin(angle), 0};
}

/// Rounding error of a rotation matrix or a quaternion that is given with six decimals.
constexpr double rotation_tolerance = 2e-6;

/// Reads the columns d1, d2, d3 of a clamp; std::nullopt if the file does not give them.
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
  const Eigen::Matrix3d orthogonality_error =
      *rows * rows->transpose() - Eigen::Matrix3d::Identity();
  if (!(orthogonality_error.cwiseAbs().maxCoeff() <= rotation_tolerance)) {
    table.fail("frame", fmt::format("rows d1, d2, d3 are off by {:.2g} from unit length or right "
                                    "angles (allowed: up to {:g})",
                                    orthogonality_error.cwiseAbs().maxCoeff(), rotation_tolerance));
  }
  if (rows->determinant() < 0) table.fail("frame", "is left-handed (allowed: d3 = d1 x d2)");
  return rows->transpose();
}

/// Reads direction and frame of a clamp. The frame is a roll, or three directors, and may be
/// missing. If the clamp's poses have directions and rolls, those of the first pose are used.
void read_clamp(StrictTable& table, Gripper& gripper) {
  const Pose first = gripper.trajectory.empty() ? Pose() : gripper.trajectory.poses().front();
  const std::optional<Eigen::Vector3d>& moving_direction = first.direction;
  if (moving_direction) {
    table.refuse({"direction", "frame", "quaternion"},
                 "given besides poses with directions (allowed: one of the two)");
  }
  std::optional<double> roll;
  std::optional<int> turns;
  table.read("roll", roll);
  table.read("turns", turns);
  const std::optional<Eigen::Matrix3d> directors = read_directors(table);
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
    table.fail("direction", fmt::format("is not d3 = [{:.6g}, {:.6g}, {:.6g}] of the frame "
                                        "(allowed: the same, or none)",
                                        d3.x(), d3.y(), d3.z()));
  }
  const Eigen::Vector3d d1 = directors->col(0);
  gripper.frame =
      FrameHold{.d1 = (d1 - d1.dot(direction) * direction).normalized(),
                .roll = 2 * std::numbers::pi * turns.value_or(0) + first.roll.value_or(0)};
}

/// Checks that a gripper is outside every obstacle.
void require_outside_obstacles(const Gripper& gripper, const Scene& scene,
                               const StrictTable& entry) {
  for (const Obstacle& obstacle : scene.obstacles) {
    const double height = obstacle.body.clearance(gripper.position);
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

}  // namespace

Gripper read_gripper(StrictTable& table, const Scene& scene) {
  Gripper gripper;
  gripper.at = read_arc_length(table, "at", scene.length);
  const std::string hold = table.choice("hold");
  PoseKeys keys{.direction = nullptr, .at = gripper.at};
  if (hold == "clamp") keys.direction = read_direction;
  gripper.trajectory = read_trajectory(table, keys, scene.file);
  gripper.position = read_place(table, "position", gripper.trajectory);
  if (hold == "clamp") {
    read_clamp(table, gripper);
  } else {
    table.refuse({"direction", "roll", "frame", "quaternion", "turns"},
                 "a pin holds neither direction nor frame (allowed: hold = \"clamp\", or none)");
  }
  gripper.where = table.where();
  table.finish();
  require_outside_obstacles(gripper, scene, table);
  return gripper;
}

void check_twist(const Scene& scene, const StrictTable& rod) {
  if (!scene.prescribes_twist()) return;
  if (!scene.torsional_stiffness && !scene.assumes_torsion()) {
    rod.fail("torsional_stiffness",
             fmt::format(
                 "missing, it is required where two clamps hold the rod's frame (allowed: "
                 "> 0; of {}, here {:.3g} N m^2 with nu = 0.3)",
                 scene.width > 0 ? "a rectangle E J / (2 (1 + nu))" : "a round rod EI / (1 + nu)",
                 scene.assumed_torsional_stiffness()));
  }
}

void check_material_directors(const Scene& scene, const StrictTable& rod,
                              const std::vector<StrictTable>& sections) {
  const bool clamped =
      std::ranges::any_of(scene.grippers, [](const Gripper& g) { return g.direction.has_value(); });
  constexpr const char* unheld =
      "no gripper holds the rod's frame (allowed: a gripper with hold = \"clamp\")";
  if (!clamped) {
    rod.refuse({"natural_curvature", "natural_twist", "helix", "rest_shape"}, unheld);
    for (const StrictTable& section : sections) {
      section.refuse({"natural_curvature", "natural_twist"}, unheld);
    }
  }
  if (!clamped && scene.has_two_stiffnesses()) {
    rod.fail(rod.has("width") ? "width" : "bending_stiffness", unheld);
  }
  (void)scene.natural_curvature();
  if (scene.has_two_stiffnesses()) (void)scene.first_frame();
}

void check_rolls(const Scene& scene, const std::vector<StrictTable>& entries) {
  if (!scene.prescribes_twist()) return;
  if (scene.has_material_directors()) (void)scene.first_frame();
  const energy_model::Problem problem = scene_problem(scene);
  const bool has_d1 = std::ranges::any_of(
      problem.grips, [](const auto& grip) { return grip.frame && grip.frame->d1; });
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const energy_model::Grip& grip = problem.grips[i];
    if (!grip.frame || grip.frame->d1) continue;
    const bool is_first = std::ranges::none_of(
        problem.grips, [&](const auto& other) { return other.frame && other.at < grip.at; });
    if (is_first && has_d1 && !scene.has_material_directors()) {
      entries[i].fail("roll",
                      "has no defined zero: a later clamp has a frame (allowed: frame or "
                      "quaternion)");
    }
    try {
      (void)energy_model::held_d1(problem, grip);
    } catch (const std::invalid_argument&) {
      entries[i].fail("roll",
                      "has no defined zero: the direction is opposite to the first clamp's and on "
                      "one line with it (allowed: frame or quaternion)");
    }
  }
}

double read_arc_length(StrictTable& table, std::string_view key, double length) {
  Range range = Range::between(0, length, " m, the rod's length");
  range.low -= arc_rounding * length;
  range.high += arc_rounding * length;
  return *on_rod(table.number(key, Dimension::length, range), length);
}

Eigen::Vector3d unit_vector(StrictTable& table, std::string_view key) {
  const Eigen::Vector3d vector = table.vector(key, Dimension::number);
  if (!(vector.norm() > 0)) table.fail(key, "must not be the zero vector");
  return vector.normalized();
}

Eigen::Vector3d read_place(StrictTable& table, const char* key, const Trajectory& trajectory) {
  if (trajectory.empty()) return table.vector(key);
  return trajectory.poses().front().position;
}

}  // namespace dlo::compare
