#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "dlo/energy_model/problem.hpp"

namespace dlo::test {

/// One to three grips above or beside a half-space, as drawn by a seed.
inline energy_model::Problem random_touching_problem(unsigned seed, bool space,
                                                     double largest_gamma) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() - std::mt19937::min()) /
                     static_cast<double>(std::mt19937::max());
  };
  const auto direction = [&] {
    const double azimuth = uniform(-M_PI, M_PI);
    const double z = space ? uniform(-1, 1) : 0;
    const double r = std::sqrt(1 - z * z);
    return Eigen::Vector3d(r * std::cos(azimuth), r * std::sin(azimuth), z);
  };
  energy_model::Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.weight_per_length = {0, -std::pow(10, uniform(0, std::log10(largest_gamma))), 0};
  std::vector<double> at = {0};
  const unsigned grips = 1 + random() % 3;
  if (grips == 3) at.push_back(uniform(0.3, 0.7));
  if (grips > 1) at.push_back(1);
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (i > 0) position += (at[i] - at[i - 1]) * uniform(0.2, 0.97) * direction();
    energy_model::Grip grip{at[i], position};
    if (i == 0 || random() % 2 == 0) grip.direction = direction();
    problem.grips.push_back(grip);
  }
  const double tilt = uniform(-0.7, 0.7);
  const double aside = space ? uniform(-0.3, 0.3) : 0;
  const std::array<Eigen::Vector3d, 3> normals = {
      Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(std::sin(tilt), std::cos(tilt), aside),
      Eigen::Vector3d(random() % 2 == 0 ? 1 : -1, tilt / 2, aside)};
  const Eigen::Vector3d n = normals[random() % 3].normalized();
  double lowest = 0;
  for (const energy_model::Grip& grip : problem.grips)
    lowest = std::min(lowest, n.dot(grip.position));
  problem.obstacles = {
      {obstacle::Body::half_space((lowest - std::pow(10, uniform(-2, -0.3))) * n, n)}};
  return problem;
}

/// The same with a peg of random radius, and in space of random direction, instead of the
/// half-space: below the middle of the grips, or of where one clamp points, and clear of all grips.
inline energy_model::Problem random_peg_problem(unsigned seed, bool space, double largest_gamma) {
  energy_model::Problem problem = random_touching_problem(seed, space, largest_gamma);
  std::mt19937 random(seed + 1000000);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() - std::mt19937::min()) /
                     static_cast<double>(std::mt19937::max());
  };
  const double radius = std::pow(10, uniform(-2, -0.7));
  const energy_model::Grip& first = problem.grips.front();
  const Eigen::Vector3d ahead = first.direction.value_or(Eigen::Vector3d::Zero());
  Eigen::Vector3d middle = first.position + 0.5 * ahead;
  if (problem.grips.size() > 1) {
    middle = (first.position + problem.grips.back().position) / 2;
  }
  const Eigen::Vector3d axis =
      space ? Eigen::Vector3d(uniform(-0.5, 0.5), uniform(-0.5, 0.5), 1) : Eigen::Vector3d(0, 0, 1);
  for (double below = uniform(0, 0.3);; below += 0.05) {
    const obstacle::Body peg =
        obstacle::Body::cylinder(middle - Eigen::Vector3d(0, below, 0), axis.normalized(), radius);
    const bool clear = std::all_of(
        problem.grips.begin(), problem.grips.end(),
        [&](const auto& grip) { return peg.clearance(grip.position) > 0.01 * problem.length; });
    if (!clear) continue;
    problem.obstacles = {{peg}};
    return problem;
  }
}

}  // namespace dlo::test
