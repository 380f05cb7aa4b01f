#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>

#include "../helpers.hpp"
#include "dlo/compare.hpp"
#include "dlo/energy_model/balance.hpp"
#include "random_contact.hpp"
#include "random_scenes.hpp"
#include "solve/polygon_solution.hpp"

namespace dlo::test {

/// Largest imbalance of the equilibria of one model.
struct LargestImbalance {
  const char* model;
  double share = 0;
  std::string scene = "none";
  int equilibria = 0;
  int refused = 0;  ///< because of their balance

  void add(const std::string& name, double found, bool refuses) {
    ++equilibria;
    refused += refuses ? 1 : 0;
    if (refuses) std::printf("  %s, %s: refused, imbalance %.1e\n", name.c_str(), model, found);
    if (found <= share) return;
    share = found;
    scene = name;
  }

  void add(const std::string& name, const energy_model::Problem& problem,
           const energy_model::Equilibrium& shape) {
    if (!shape.sample) return;
    const bool refuses = shape.message.find("unbalanced force") != std::string::npos;
    const bool claims =
        succeeded(shape.status) || shape.status == energy_model::SolveStatus::saddle ||
        (shape.status == energy_model::SolveStatus::not_verified && !has_potential(problem));
    if (claims || refuses) add(name, imbalance_of(problem, shape).share(), refuses);
  }
};

/// Returns a rod of random_problem(). Consecutive numbers cycle through the kinds. Half of the rods
/// of kinds other than `curved` have a line load that varies along the rod. Three of ten planar
/// rods have a couple about the plane's normal.
inline energy_model::Problem loaded_problem(std::uint64_t number) {
  constexpr std::array kinds = {RandomSpace::plane,  RandomSpace::space, RandomSpace::twisted,
                                RandomSpace::curved, RandomSpace::mixed, RandomSpace::strip};
  energy_model::Problem problem = random_problem(number, kinds[number % kinds.size()]);
  RandomNumbers random((1ULL << 34U) + number);
  const RandomSpace space = number % kinds.size() == 0 ? RandomSpace::plane : RandomSpace::space;
  const double size = std::max(1.0, problem.weight_per_length.norm()) / 2;
  if (random.chance(0.5) && kinds[number % kinds.size()] != RandomSpace::curved) {
    problem.line_loads.push_back({random_arc_length(random, 0, 0.4),
                                  random_arc_length(random, 0.5, 1), size * random.direction(space),
                                  -size * random.direction(space)});
  }
  if (space == RandomSpace::plane && random.chance(0.3)) {
    problem.loads.push_back({random_arc_length(random, 0.1, 1), Eigen::Vector3d::Zero(),
                             random.uniform(-3, 3) * Eigen::Vector3d::UnitZ()});
  }
  return problem;
}

/// Returns a random rod that only exact solves: it stretches, is in a stream, or has a follower
/// load.
inline energy_model::Problem problem_of_exact(std::uint64_t number) {
  energy_model::Problem problem =
      random_problem(number, number % 2 == 0 ? RandomSpace::plane : RandomSpace::space);
  RandomNumbers random((1ULL << 35U) + number);
  const double size = std::max(1.0, problem.weight_per_length.norm());
  if (random.chance(0.5)) {
    problem.axial_stiffness = 1e3 * size;
  } else if (random.chance(0.5)) {
    problem.drag = energy_model::Drag{random.direction(RandomSpace::space), size, size / 50};
  } else {
    problem.loads.push_back({random.uniform(0.2, 1), random.direction(RandomSpace::space),
                             random.direction(RandomSpace::space), true});
  }
  return problem;
}

/// Returns a rod with a floor, a wall or a body that it may touch: a rigid one, or in every third
/// problem one that yields. Returns std::nullopt if no obstacle is found.
inline std::optional<energy_model::Problem> touching_problem(std::uint64_t number) {
  const auto seed = static_cast<unsigned>(number);
  const bool space = number % 2 == 0;
  std::optional<energy_model::Problem> problem;
  if (number % 5 == 0) {
    problem = random_framed_problem(seed, space);
  } else if (number % 5 < 3) {
    problem = random_problem_with_body(seed, space);
  } else {
    problem = random_touching_problem(seed, space, 1e4);
  }
  if (!problem || number % 3 != 0) return problem;
  for (energy_model::Obstacle& obstacle : problem->obstacles) {
    obstacle.stiffness = 30 * (1 + problem->weight_per_length.norm());
  }
  return problem;
}

/// Adds the imbalances of chain and force model for a problem that a scene file can describe.
inline void add_polygons(const std::string& name, const energy_model::Problem& problem,
                         double time_limit, std::array<LargestImbalance, 2>& polygons) {
  compare::Scene scene = compare::parse_scene(scene_text(problem, name), name + ".toml");
  scene.force_model.points = 31;
  for (const compare::Model model : {compare::Model::chain, compare::Model::force}) {
    LargestImbalance& largest = polygons[model == compare::Model::force ? 1 : 0];
    try {
      const compare::Solution solution = compare::solve(scene, model, {.time_limit = time_limit});
      const compare::Discretisation polygon = compare::discretise(scene, scene.force_model);
      // The shape ends at the clamps' reference points, but the loads act on the points of the
      // polygon.
      Eigen::Matrix3Xd points = solution.shape.points;
      for (const force_model::Grip& grip : polygon.rod.grips) {
        points.middleCols(grip.first_point, grip.targets.cols()) = grip.targets;
      }
      const energy_model::Imbalance left =
          compare::polygon_imbalance(polygon.rod, points, solution.grippers);
      largest.add(name, left.share(), false);
      if (model == compare::Model::force && left.share() > energy_model::allowed_imbalance) {
        std::printf("  %s, force: imbalance %.1e, %.1e l from rest\n", name.c_str(), left.share(),
                    solution.error_estimate / scene.length);
      }
    } catch (const std::exception& error) {
      const std::string message = error.what();
      const bool refuses = message.find("unbalanced force") != std::string::npos;
      if (refuses) {
        std::printf("%s\n", message.c_str());
        largest.add(name, 0, true);
      }
    }
  }
}

/// Solves scenes of all kinds with every model, and prints a line for each model.
/// @return how many shapes were refused because of their balance
inline int print_imbalances(std::uint64_t first, std::uint64_t scenes, double time_limit) {
  LargestImbalance energy{"energy"};
  LargestImbalance exact{"exact"};
  std::array<LargestImbalance, 2> polygons = {{{"chain"}, {"force"}}};
  for (std::uint64_t number = first; number < first + scenes; ++number) {
    const std::string name = "scene " + std::to_string(number);
    try {
      if (number % 10 == 9) {
        const energy_model::Problem problem = problem_of_exact(number);
        exact.add(name, problem, solve_exact(problem, {.time_limit = time_limit}));
        continue;
      }
      const bool touches = number % 10 > 5;
      const std::optional<energy_model::Problem> problem =
          touches ? touching_problem(number) : loaded_problem(number);
      if (!problem) continue;
      const energy_model::Equilibrium shape = solve_energy(*problem, {.time_limit = time_limit});
      energy.add(name, *problem, shape);
      const bool polygon = problem->obstacles.empty() && problem->line_loads.empty() &&
                           !has_couples(*problem) && !has_material_directors(*problem);
      if (polygon) add_polygons(name, *problem, time_limit, polygons);
      const bool yields =
          std::any_of(problem->obstacles.begin(), problem->obstacles.end(),
                      [](const energy_model::Obstacle& o) { return std::isfinite(o.stiffness); });
      if (!shape.sample || yields) continue;
      exact.add(name, *problem, solve_exact(*problem, {.time_limit = time_limit, .start = &shape}));
    } catch (const std::invalid_argument& error) {
      std::printf("  %s: %s\n", name.c_str(), error.what());
    }
  }
  int refused = 0;
  for (const LargestImbalance& model : {energy, exact, polygons[0], polygons[1]}) {
    std::printf("%-6s largest imbalance of %d equilibria %.1e (%s), %d refused\n", model.model,
                model.equilibria, model.share, model.scene.c_str(), model.refused);
    refused += model.refused;
  }
  return refused;
}

}  // namespace dlo::test
