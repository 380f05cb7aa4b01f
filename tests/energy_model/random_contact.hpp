#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "../helpers.hpp"
#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"

namespace dlo::test {

/// Returns a problem with one to three grips above or next to a half-space, drawn by a seed.
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
    // One draw a statement: compilers evaluate operands in orders of their own.
    if (i > 0) {
      const double share = uniform(0.2, 0.97);
      position += (at[i] - at[i - 1]) * share * direction();
    }
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

inline double draw_uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * std::generate_canonical<double, 53>(random);
}

/// Returns a unit vector, in the x-y plane unless `space`.
inline Eigen::Vector3d draw_direction(std::mt19937& random, bool space, double least_x = -1) {
  const double x = draw_uniform(random, least_x, 1);
  const double y = draw_uniform(random, -1, 1);
  return Eigen::Vector3d(x, y, space ? draw_uniform(random, -1, 1) : 0).normalized();
}

/// Adds a body that the shape without it would penetrate, clear of the grips. @return whether there
/// is one
inline bool add_penetrated_body(std::mt19937& random, bool space, energy_model::Problem& problem) {
  const energy_model::Equilibrium free = energy_model::solve_energy(problem);
  if (!energy_model::succeeded(free.status)) return false;
  for (int attempt = 0; attempt < 100; ++attempt) {
    const double radius = std::pow(10, draw_uniform(random, -2, -0.7));
    const double turn = draw_uniform(random, 0, 6.28);
    const Eigen::Vector3d aside(std::cos(turn), std::sin(turn),
                                space ? draw_uniform(random, -0.5, 0.5) : 0);
    const double at = draw_uniform(random, 0.2, 1);
    const double off = radius * draw_uniform(random, 0.3, 0.9);
    const Eigen::Vector3d centre =
        free.sample(std::array{at}).points.col(0) + off * aside.normalized();
    const double leans_x = space ? draw_uniform(random, -0.5, 0.5) : 0;
    const double leans_y = space ? draw_uniform(random, -0.5, 0.5) : 0;
    const Eigen::Vector3d axis(leans_x, leans_y, 1);
    const std::array<obstacle::Body, 3> bodies = {
        obstacle::Body::cylinder(centre, axis, radius), obstacle::Body::sphere(centre, radius),
        obstacle::Body::capsule(centre, axis, 0.2, radius)};
    const obstacle::Body& body = bodies[random() % 3];
    bool clear = true;
    for (const energy_model::Grip& grip : problem.grips) {
      for (const double way : {-0.06, -0.03, 0.0, 0.03, 0.06}) {
        const Eigen::Vector3d along =
            grip.direction ? Eigen::Vector3d(way * *grip.direction) : Eigen::Vector3d::Zero();
        clear = clear && body.clearance(grip.position + along) > 0.01;
      }
    }
    if (!clear) continue;
    problem.obstacles = {{body}};
    return true;
  }
  return false;
}

/// Returns a rod with a cylinder, a ball or a capsule, drawn by a seed. The rod is clamped at its
/// begin, and in half of the cases also held at its end. Without the body the rod's shape would
/// penetrate it. Returns std::nullopt if no such body is found.
inline std::optional<energy_model::Problem> random_problem_with_body(unsigned seed, bool space) {
  std::mt19937 random(seed + 977 * static_cast<unsigned>(space));
  energy_model::Problem problem = heavy_cantilever(std::pow(10, draw_uniform(random, 0, 4)), 0);
  problem.grips[0].direction = draw_direction(random, space);
  if (random() % 2 == 0) {
    const double reach = draw_uniform(random, 0.3, 0.9);
    problem.grips.push_back({1, reach * draw_direction(random, space)});
    if (random() % 2 == 0) problem.grips[1].direction = draw_direction(random, space);
  }
  if (!add_penetrated_body(random, space, problem)) return std::nullopt;
  return problem;
}

/// Adds a half-space that the shape without it would penetrate, clear of the grips. @return whether
/// there is one
inline bool add_penetrated_half_space(std::mt19937& random, bool space,
                                      energy_model::Problem& problem) {
  const energy_model::Equilibrium free = energy_model::solve_energy(problem);
  if (!energy_model::succeeded(free.status)) return false;
  const double tilt = draw_uniform(random, -0.5, 0.5);
  const double aside = space ? draw_uniform(random, -0.3, 0.3) : 0;
  const Eigen::Vector3d normal = Eigen::Vector3d(tilt, 1, aside).normalized();
  const auto s = energy_model::equal_arc_lengths(problem.length, 201);
  const double lowest = (normal.transpose() * free.sample(s).points).minCoeff();
  double grips = INFINITY;
  for (const energy_model::Grip& grip : problem.grips) {
    // The parts of the rod next to the clamp are clear of the floor too.
    for (const double way : {-0.03, 0.0, 0.03}) {
      grips = std::min(grips, normal.dot(grip.position + way * *grip.direction));
    }
  }
  if (!(grips - lowest > 0.02)) return false;
  const double height = lowest + draw_uniform(random, 0.1, 0.9) * (grips - lowest);
  problem.obstacles = {{obstacle::Body::half_space(height * normal, normal)}};
  return true;
}

/// Returns a rod with a half-space or a body, drawn by a seed. The rod is between clamps that hold
/// its frame, and the last clamp is rotated by up to one turn in either sense. Without the obstacle
/// the rod's shape would penetrate it. Returns std::nullopt if no such obstacle is found.
inline std::optional<energy_model::Problem> random_framed_problem(unsigned seed, bool space) {
  std::mt19937 random(seed + 1009 * static_cast<unsigned>(space));
  energy_model::Problem problem = heavy_cantilever(std::pow(10, draw_uniform(random, 0, 3)), 0);
  problem.torsional_stiffness = draw_uniform(random, 0.5, 1);
  problem.grips[0].direction = draw_direction(random, space, -0.2);
  problem.grips[0].frame = energy_model::FrameHold{};
  const double reach = draw_uniform(random, 0.4, 0.95);
  problem.grips.push_back({1, reach * draw_direction(random, space, 0.5),
                           draw_direction(random, space, -0.2), energy_model::FrameHold{}});
  problem.grips[1].frame->roll = draw_uniform(random, -1, 1) * 2 * M_PI;
  const bool placed = random() % 2 == 0 ? add_penetrated_half_space(random, space, problem)
                                        : add_penetrated_body(random, space, problem);
  if (!placed) return std::nullopt;
  return problem;
}

}  // namespace dlo::test
