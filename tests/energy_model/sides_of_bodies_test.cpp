// A rod with one clamp and a rigid body in its way: the side that costs less is found.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

using test::heavy_cantilever;

/// A block across the way of a rod that rises from its clamp.
Problem with_block_in_the_way(int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * std::generate_canonical<double, 53>(random);
  };
  const double rise = uniform(20, 60);
  const double gamma = uniform(2, 6);
  Problem problem = heavy_cantilever(gamma, rise);
  const double at = uniform(0.2, 0.4);
  const Equilibrium free = solve_energy(problem);
  const Eigen::Vector3d point = test::point_at(free, at);
  const double turn = std::atan2(point.y(), point.x()) + uniform(-0.3, 0.3);
  const Eigen::Matrix3d axes = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d centre = point + uniform(-0.04, 0.04) * axes.col(1);
  problem.obstacles = {{obstacle::Body::box(centre, axes, {0.06, 0.2, 0.3}, 0.01)}};
  return problem;
}

// Whatever side a load pulls the rod to, and wherever it stays without the load: what is found
// without help costs no more.
TEST(SidesOfBodies, WhatIsFoundCostsNoMoreThanWhatALoadLeadsTo) {
  constexpr int scenes = 100;
  int led = 0;
  for (int seed = 0; seed < scenes; ++seed) {
    const Problem problem = with_block_in_the_way(seed);
    const Equilibrium found = solve_energy(problem);
    ASSERT_EQ(found.status, SolveStatus::converged) << seed << ": " << found.message;
    for (const double pull : {-30.0, -10.0, 10.0, 30.0}) {
      Problem pulled = problem;
      pulled.loads = {{1, pull * Eigen::Vector3d(problem.obstacles.front().body.axes().col(1))}};
      const Equilibrium aside = solve_energy(pulled);
      if (aside.status != SolveStatus::converged) continue;
      const Equilibrium left = solve_energy(problem, {.start = &aside});
      if (left.status != SolveStatus::converged) continue;
      ++led;
      EXPECT_LE(found.energy.total(), left.energy.total() + 1e-6) << seed << ", pulled by " << pull;
    }
  }
  EXPECT_GE(led, 3 * scenes);
}

}  // namespace
}  // namespace dlo::energy_model
