#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "reading/read_parts.hpp"
#include "toml/strict_table.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

/// Reads a box with the edges `size` along `axis`, along `normal` and perpendicular to both.
obstacle::Body read_box(StrictTable& table, const Eigen::Vector3d& centre) {
  const Eigen::Vector3d size = table.vector("size");
  if (!(size.minCoeff() > 0)) table.fail("size", "has to be three lengths > 0");
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  if (table.has("axis")) axes.col(0) = unit_vector(table, "axis");
  if (table.has("normal")) axes.col(1) = unit_vector(table, "normal");
  constexpr double perpendicular_tolerance = 1e-6;
  if (std::abs(axes.col(0).dot(axes.col(1))) > perpendicular_tolerance) {
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

obstacle::Body read_body(StrictTable& table, const Eigen::Vector3d& point) {
  const std::string shape = table.choice("shape");
  if (shape == "plane") {
    return obstacle::Body::half_space(point, unit_vector(table, "normal"));
  }
  if (shape == "sphere") {
    return obstacle::Body::sphere(point, table.number("radius"));
  }
  if (shape == "cylinder") {
    return obstacle::Body::cylinder(point, unit_vector(table, "axis"), table.number("radius"));
  }
  if (shape == "capsule") {
    return obstacle::Body::capsule(point, unit_vector(table, "axis"), table.number("length"),
                                   table.number("radius"));
  }
  return read_box(table, point);
}

}  // namespace

Obstacle read_obstacle(StrictTable& table, const Scene& scene) {
  Obstacle obstacle;
  obstacle.trajectory =
      read_trajectory(table, {.position = "point", .direction = nullptr}, scene.file);
  const Eigen::Vector3d point = read_place(table, "point", obstacle.trajectory);
  obstacle.body = read_body(table, point);
  table.read("stiffness", obstacle.stiffness);
  table.read("friction", obstacle.friction);
  const bool axis = table.choice("touches") == "axis";
  if (!axis && scene.width > 0) {
    table.fail("touches",
               "missing or \"surface\", which is not at one distance from the axis of a rod with "
               "width and thickness (allowed: touches = \"axis\")");
  }
  if (!axis) obstacle.body = obstacle.body.enlarged(scene.diameter / 2);
  if (!(obstacle.body.smallest_radius() > 0)) {
    table.fail(axis ? "touches" : "size",
               "a box whose edges are sharp, over which the rod would bend without a radius "
               "(allowed: radius > 0, which rounds its edges, or the surface of a rod with a "
               "diameter)");
  }
  table.finish();
  return obstacle;
}

}  // namespace dlo::compare
