#include "dlo/force_model/heuristics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "require.hpp"

namespace dlo::force_model {
namespace {

void require_points(const char* function, int points) {
  require(points >= 3, function, "points", points, ">= 3");
}

}  // namespace

double quarter_circle_force(int points) {
  require_points("quarter_circle_force", points);
  const double alpha = std::numbers::pi / 2 / (points - 1);
  return (1 - std::cos(alpha)) * std::sqrt((1 - std::cos(alpha)) / 2);  // (9)
}

QuarterCircle smallest_quarter_circle(double length, int points, double alpha) {
  require_positive("smallest_quarter_circle", "length", length);
  require_points("smallest_quarter_circle", points);
  require(alpha > 0 && alpha < std::numbers::pi, "smallest_quarter_circle", "alpha", alpha,
          "in (0, pi)");
  return {.radius = length / (points - 1) / (2 * std::sin(alpha / 2)),  // (10)
          .segments = std::numbers::pi / 2 / alpha};
}

int points_for_radius(double length, double radius, double alpha) {
  require_positive("points_for_radius", "length", length);
  require_positive("points_for_radius", "radius", radius);
  require(alpha > 0 && alpha < std::numbers::pi, "points_for_radius", "alpha", alpha, "in (0, pi)");
  const double segments = length / (2 * radius * std::sin(alpha / 2));  // (10)
  require(segments < 1e9, "points_for_radius", "length / radius", length / radius,
          "small enough for 1e9 points");
  return std::max(5, static_cast<int>(std::ceil(segments)) + 1);
}

double contraction_stiffness(double force, double percent) {
  require_positive("contraction_stiffness", "force", force);
  require_positive("contraction_stiffness", "percent", percent);
  return force * 100 / percent;  // (11)
}

double contraction_stiffness(double mass, double gravity, double percent) {
  require_positive("contraction_stiffness", "mass", mass);
  require_positive("contraction_stiffness", "gravity", gravity);
  return contraction_stiffness(mass * gravity, percent);  // (12)
}

double bending_stiffness(double force, double alpha, Formula13 variant) {
  require_positive("bending_stiffness", "force", force);
  require(alpha > 0 && alpha < std::numbers::pi / 2, "bending_stiffness", "alpha", alpha,
          "in (0, pi/2)");
  const double factor =
      variant == Formula13::printed ? std::sin(std::numbers::pi - alpha) : std::cos(alpha);
  return force * factor / ((1 - std::cos(alpha)) * std::sin(alpha / 2));  // (13)
}

double grip_stiffness(double weight, double distance) {
  require_positive("grip_stiffness", "weight", weight);
  require_positive("grip_stiffness", "distance", distance);
  return weight / distance;  // (14)
}

}  // namespace dlo::force_model
