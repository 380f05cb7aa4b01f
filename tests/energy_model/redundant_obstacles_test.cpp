// Tests of rods on two or more rigid obstacles, one within the other, with flush or separate
// surfaces.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "../sanitized.hpp"
#include "contact_samples.hpp"
#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

using Body = obstacle::Body;

/// A clamped rod above a floor or a table, and bodies inside the obstacle below it.
struct RedundantScene {
  Problem plain;
  Problem with_redundant;
};

class RedundantScenes {
 public:
  RedundantScene next() {
    RedundantScene scene;
    const double height = between(0.05, 0.3);
    scene.plain = test::heavy_cantilever(between(20, 150), between(-20, 20));
    const bool table = random_() % 3 == 0;
    // The table is longer than the rod and 0.4 high, with round edges.
    const Body ground =
        table ? Body::box({0.5, -height - 0.2, 0}, axes_, {4, 0.4, 2}, between(0.01, 0.05))
              : Body::half_space({0, -height, 0}, {0, 1, 0});
    scene.plain.obstacles = {{ground}};
    scene.with_redundant = scene.plain;
    std::vector<Obstacle>& all = scene.with_redundant.obstacles;
    for (unsigned count = 1 + random_() % 3; count > 0; --count) {
      all.push_back({within(ground, height)});
    }
    std::shuffle(all.begin(), all.end(), random_);
    return scene;
  }

 private:
  Body within(const Body& ground, double height) {
    const double x = between(0.1, 0.9);
    const double size = between(0.05, 0.3);
    switch (random_() % 4) {
      case 0:
        return ground;
      case 1: {  // flush
        const double radius = size * between(0.05, 0.4);
        return Body::box({x, -height - size / 2, 0}, axes_, {2 * size, size, size}, radius);
      }
      case 2:  // below by little
        if (ground.is_half_space()) {
          return Body::half_space({x, -height - std::pow(10, between(-12, -3)), 0}, {0, 2, 0});
        }
        return Body::box({0.5, -height - 0.2, 0}, axes_, {3, 0.4, 1}, ground.radius());
      default:  // touching the surface from within
        return Body::sphere({x, -height - size / 2, between(-0.1, 0.1)}, size / 2);
    }
  }

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  std::mt19937 random_{20};
  Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();
};

TEST(RedundantObstacles, AreAsIfTheyWereNotThere) {
  const std::vector<double> s = {0, 0.1, 0.25, 0.4, 0.6, 0.75, 0.9, 1};
  RedundantScenes scenes;
  const int draws = test::draws(100);
  int certified = 0;
  for (int i = 0; i < draws; ++i) {
    const RedundantScene scene = scenes.next();
    const EnergyOptions options{.time_limit = 60};
    const Equilibrium alone = solve_energy(scene.plain, options);
    const Equilibrium found = solve_energy(scene.with_redundant, options);
    ASSERT_EQ(found.status, alone.status) << i << " " << found.message;
    if (!succeeded(found.status)) continue;
    ++certified;
    test::expect_only_pushed(scene.with_redundant, found);
    EXPECT_NEAR(found.energy.total(), alone.energy.total(),
                1e-9 * std::abs(alone.energy.total()) + 1e-9)
        << i;
    EXPECT_LT(test::largest_point_distance(found, alone, s), 1e-7) << i;
    Eigen::Vector3d pushed = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& force : found.obstacles) pushed += force;
    EXPECT_LT((pushed - alone.obstacles.front()).norm(), 1e-6 * (1 + pushed.norm())) << i;
  }
  EXPECT_GE(certified, draws * 95 / 100);
}

TEST(RedundantObstacles, ABodyThatSticksOutCounts) {
  // A box on the floor within the rod's reach, and one that protrudes equally from the floor but
  // out of the rod's reach.
  Problem problem = test::heavy_cantilever(80, 0);
  const Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  problem.obstacles = {{Body::half_space({0, -0.2, 0}, {0, 1, 0})},
                       {Body::box({0.5, -0.2, 0}, axes, {0.3, 0.1, 0.4}, 0.03)},
                       {Body::box({3, -0.2, 0}, axes, {0.3, 0.1, 0.4}, 0.03)}};
  const Equilibrium found = test::require_usable(solve_energy(problem));
  EXPECT_GT(found.obstacles.at(1).norm(), 0);
  EXPECT_EQ(found.obstacles.at(2).norm(), 0);
  test::expect_only_pushed(problem, found);
}

// On floors that differ by a small tilt the rod rests as on the one that is highest where it lies.
TEST(RedundantObstacles, FloorsThatAreTiltedALittleAreAsTheHighestOne) {
  const auto floor = [](double slope) {
    return Obstacle{Body::half_space({0, -0.2, 0}, {-slope, 1, 0})};
  };
  for (const double tilt : {1e-9, 1e-7, 1e-6, 3e-5, 1e-4}) {
    for (const std::vector<double>& slopes :
         {std::vector{0.0, -tilt, -2 * tilt}, std::vector{0.0, tilt, -tilt},
          std::vector{-tilt, 2 * tilt, tilt}}) {
      Problem problem = test::heavy_cantilever(80, 0);
      problem.obstacles = {floor(*std::ranges::max_element(slopes))};
      const Equilibrium highest = test::require_usable(solve_energy(problem));
      problem.obstacles.clear();
      for (const double slope : slopes) problem.obstacles.push_back(floor(slope));
      const Equilibrium found = solve_energy(problem);
      ASSERT_EQ(found.status, SolveStatus::converged) << tilt << found.message;
      EXPECT_LT(test::largest_point_distance(found, highest), 1e-8) << tilt;
      EXPECT_LE(found.penetration, allowed_penetration) << tilt;
    }
  }
}

// A block protrudes from the floor below the rod by less than the tolerance for flush faces, and
// must not act as a wall.
TEST(RedundantObstacles, ABlockSunkToItsTopIsNoWall) {
  Problem problem = test::heavy_cantilever(80, 0);
  problem.obstacles = {{Body::half_space({0, -0.2, 0}, {0, 1, 0})}};
  const Equilibrium alone = solve_energy(problem);
  const Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  problem.obstacles.push_back({Body::box({0.1, -0.25 + 5e-7, 0}, axes, {0.1, 0.1, 4}, 0.01)});
  const Equilibrium found = test::require_usable(solve_energy(problem));
  EXPECT_LT(test::largest_point_distance(found, alone), 1e-8);
  EXPECT_LT(found.evaluations, 2 * alone.evaluations);
}

// If the lower face of a block pushed out the rod, the rod would be caught between the block and
// the floor.
TEST(RedundantObstacles, ABlockThatStandsOnTheFloorCarriesARodAsADeeperOne) {
  struct Scene {
    double gamma, pitch, depth;  // of the block's top
  };
  for (const auto& [gamma, pitch, depth] : {Scene{50, -5, 0.15}, {193, 14.7, 0.0826}}) {
    SCOPED_TRACE(gamma);
    Problem problem = test::heavy_cantilever(gamma, pitch);
    const auto on_block = [&, depth = depth](double bottom) {
      const Eigen::Vector3d size(2.6, bottom - depth, 4);
      Problem result = problem;
      result.obstacles = {{Body::half_space({0, -depth - 0.1, 0}, {0, 1, 0})},
                          {Body::box({0.4 + size.x() / 2, -(depth + bottom) / 2, 0},
                                     Eigen::Matrix3d::Identity(), size, 0.01)}};
      return result;
    };
    const Equilibrium found = test::converged(solve_energy(on_block(depth + 0.1)));
    EXPECT_GT(found.obstacles.at(1).y(), 0);
    EXPECT_LT(found.evaluations, 5000);  // from 1180 and 2322; caught there, 9010 and 16250
    const Equilibrium deeper =
        test::converged(solve_energy(on_block(depth + 0.3), {.start = &found}));
    EXPECT_LT(test::largest_point_distance(found, deeper), 1e-8);
  }
}

}  // namespace
}  // namespace dlo::energy_model
