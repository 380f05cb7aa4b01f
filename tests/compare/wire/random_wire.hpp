#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "../../helpers.hpp"
#include "../measured_shapes.hpp"
#include "dlo/compare/material_fit.hpp"
#include "dlo/energy_model/energy.hpp"
#include "polygon/energy_problems.hpp"

namespace dlo::test {

using compare::Gripper;
using compare::MeasuredShape;
using compare::Scene;

inline constexpr double one_degree = std::numbers::pi / 180;
inline constexpr double nominal_stiffness = 1e-3;      // EI of the scenes [N m^2]
inline constexpr double camera_tilt = 2 * one_degree;  // standard deviation, one of all mountings
// Standard deviation of the clamp error shared by all mountings.
inline constexpr double fixture_error = 20 * one_degree;
// Standard deviation of the clamp error of each mounting.
inline constexpr double own_error = 5 * one_degree;
inline constexpr double curvature = 2;  // standard deviation of a term of natural curvature [1/m]
// Standard deviation of a coordinate; errors are correlated [m].
inline constexpr double point_error = 0.003;
// Correlation length of the errors, divided by the rod length.
inline constexpr double error_length = 0.2;

inline Scene nominal_scene(double EI) {
  Scene scene;
  scene.name = scene.file = "wire";
  scene.length = 1.5;
  scene.given_bending_stiffness = EI;
  scene.given_mass_per_length = 0.0215;
  scene.gravity = {0, -9.81, 0};
  scene.grippers = {{.at = 0, .position = {0, 0, 0}, .direction = Eigen::Vector3d::UnitX()},
                    {.at = 1.5, .position = {-0.12, 0, 0}, .direction = Eigen::Vector3d::UnitX()}};
  return scene;
}

inline Eigen::Vector3d turned(const Eigen::Vector3d& vector, double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * vector;
}

/// Wire between two clamps, photographed in several mountings in one fixture that is not known
/// accurately.
struct Wire {
  double EI = 0;
  std::vector<Scene> scenes;
  std::vector<MeasuredShape> shapes;
};

/// Returns a wire with random properties and its measured shapes, drawn by a seed.
/// @param count   number of shapes
/// @param points  number of points of each shape
inline Wire random_wire(unsigned seed, int count, int points = 50) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Wire wire{.EI = nominal_stiffness * std::exp(0.3 * normal(random))};
  Scene truth = nominal_scene(wire.EI);
  truth.natural_strain.y() = curvature * normal(random);
  truth.natural_variation = {{0, curvature * normal(random)}, {0, curvature * normal(random)}};
  const double tilt = camera_tilt * normal(random);
  for (Gripper& clamp : truth.grippers) {
    clamp.direction = turned(*clamp.direction, fixture_error * normal(random));
  }
  for (int i = 0; i < count; ++i) {
    Scene mounted = truth;
    for (Gripper& clamp : mounted.grippers) {
      clamp.direction = turned(*clamp.direction, own_error * normal(random));
    }
    energy_model::Problem problem = compare::energy_problem(mounted);
    problem.confined_to_plane = true;
    const std::vector<double> s = compare::equal_arc_lengths(mounted.length, points);
    Eigen::Matrix3Xd seen = energy_model::solve_energy(problem).sample(s).points;
    seen = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitZ()).matrix() * seen;
    const double length = error_length * mounted.length;
    seen += correlated_noise(s, point_error, length, random);
    seen.row(2).setZero();
    wire.scenes.push_back(nominal_scene(nominal_stiffness));
    wire.shapes.push_back({"seen", seen, {}});
  }
  return wire;
}

}  // namespace dlo::test
