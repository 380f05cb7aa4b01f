#pragma once

#include <cmath>
#include <numbers>

#include "../helpers.hpp"
#include "dlo/compare/scene.hpp"

namespace dlo::test {

/// Returns a rod of 1 m under its weight along -y, clamped at the origin at an angle of `degrees`
/// from +x towards +y.
/// @param gamma  weight divided by bending stiffness, w l^3 / (EI)
inline compare::Scene heavy_scene(double gamma, double degrees) {
  compare::Scene scene;
  scene.name = "heavy";
  scene.file = "heavy.toml";
  scene.length = 1;
  scene.diameter = 0.002;
  scene.material = {.name = "own", .youngs_modulus = 210e9, .density = 7900, .source = "test"};
  scene.gravity = {0, -1, 0};
  scene.gravity.y() = -gamma / scene.gamma();
  const double angle = degrees * std::numbers::pi / 180;
  scene.grippers = {{.at = 0,
                     .position = Eigen::Vector3d::Zero(),
                     .direction = Eigen::Vector3d(std::cos(angle), std::sin(angle), 0)}};
  return scene;
}

/// Returns a scene with Young's modulus multiplied by a factor.
inline compare::Scene with_modulus_times(double factor, compare::Scene scene) {
  scene.material.youngs_modulus *= factor;
  return scene;
}

/// Returns heavy_scene(gamma, 0) with a second clamp at the rod's end.
inline compare::Scene two_clamps(double gamma, const Eigen::Vector3d& end,
                                 const Eigen::Vector3d& direction = Eigen::Vector3d::UnitX()) {
  compare::Scene scene = heavy_scene(gamma, 0);
  scene.grippers.push_back({.at = 1, .position = end, .direction = direction.normalized()});
  return scene;
}

}  // namespace dlo::test
