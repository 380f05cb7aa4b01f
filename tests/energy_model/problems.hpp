#pragma once

#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>
#include <string>

#include "../helpers.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::test {

using Eigen::Vector3d;
using std::numbers::pi;

/// Both solvers with their default options.
inline constexpr std::array<energy_model::Equilibrium (*)(const energy_model::Problem&), 2>
    solvers = {
        [](const energy_model::Problem& problem) { return energy_model::solve_energy(problem); },
        [](const energy_model::Problem& problem) { return energy_model::solve_exact(problem); }};

/// Gamma = w l^3 / (EI) at which an upright clamped rod buckles under its own weight: z^3 with z
/// the first root of sqrt(3) Ai(-z) + Bi(-z). The digits are those of reference_values.json.
constexpr double self_buckling_gamma = 7.837347438943483;

/// Returns a rod of unit length and stiffness under its weight Gamma along -y, clamped at the
/// origin in the x-y plane, at `degrees` from x towards y.
inline energy_model::Problem heavy_cantilever(double gamma, double degrees) {
  energy_model::Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.weight_per_length = {0, -gamma, 0};
  const double angle = degrees * std::numbers::pi / 180;
  Eigen::Vector3d direction(std::cos(angle), std::sin(angle), 0);
  // Exactly upright and exactly hanging, which the cosine of a rounded pi/2 is not.
  if (std::abs(degrees) == 90) direction.x() = 0;
  problem.grips = {{.at = 0, .position = Eigen::Vector3d::Zero(), .direction = direction}};
  return problem;
}

/// Returns heavy_cantilever(gamma, 0) over a level floor so far below its clamp.
inline energy_model::Problem over_floor(double gamma, double height) {
  energy_model::Problem problem = heavy_cantilever(gamma, 0);
  problem.obstacles = {{obstacle::Body::half_space({0, -height, 0}, {0, 1, 0})}};
  return problem;
}

/// Returns a horizontal rod whose end is clamped in the same direction at the distance `span`.
inline energy_model::Problem two_clamps(double gamma, double span) {
  energy_model::Problem problem = heavy_cantilever(gamma, 0);
  problem.grips.push_back({1, {span, 0, 0}, Eigen::Vector3d(1, 0, 0)});
  return problem;
}

/// Returns data/reference/reference_values.json, which states the sources of its numbers.
inline nlohmann::json reference_values() {
  std::ifstream stream(std::string(DLO_DATA) + "/reference/reference_values.json");
  if (!stream) throw std::runtime_error("reference_values.json is missing");
  return nlohmann::json::parse(stream);
}

}  // namespace dlo::test
