// Tests of rods on yielding obstacles: their energy against the work that moving an obstacle takes.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

struct YieldingScene {
  std::string name;
  Problem problem;
  Eigen::Vector3d way;  // along which the obstacle is moved, unit
};

std::vector<YieldingScene> yielding_scenes() {
  using obstacle::Body;
  std::vector<YieldingScene> scenes;
  Problem floor = heavy_cantilever(12, 0);
  floor.obstacles = {{Body::half_space({0, -0.17, 0}, {0, 1, 0}), 130}};
  scenes.push_back({"floor", floor, {0, 1, 0}});
  Problem peg = heavy_cantilever(9, 0);
  peg.grips.push_back({1, {0.75, -0.08, 0}});
  peg.obstacles = {{Body::cylinder({0.45, -0.36, 0}, {0, 0, 1}, 0.1), 400}};
  scenes.push_back({"cylinder", peg, {0, 1, 0}});
  Problem ball = heavy_cantilever(15, 10);
  ball.grips.push_back({1, {0.6, 0.1, 0.2}, Eigen::Vector3d(1, 0.4, 0.3)});
  ball.obstacles = {{Body::sphere({0.35, -0.25, 0.1}, 0.15), 300}};
  scenes.push_back({"ball", ball, {0.3, 0.9, 0.1}});
  scenes.back().way.normalize();
  // The axis of the cylinder is 0.01 l away from the rod, and the contact force changes direction
  // within this distance.
  Problem deep = heavy_cantilever(2, 0);
  deep.grips.push_back({1, {0.98, 0, 0}, Eigen::Vector3d::UnitX()});
  deep.obstacles = {{Body::cylinder({0.43, -0.03, 0}, {0, 0, 1}, 0.09), 2e4}};
  scenes.push_back({"axis", deep, {0.6, 0.8, 0}});
  // The rod passes under an edge of the block, from where one face pushes to where another one
  // does.
  Problem ridge = heavy_cantilever(2, 0);
  ridge.grips.push_back({1, {0.98, 0, 0}, Eigen::Vector3d::UnitX()});
  const Eigen::Matrix3d axes =
      (Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.25 * std::numbers::pi, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  ridge.obstacles = {{Body::box({0.45, -0.06, 0}, axes, {0.1, 0.1, 0.6}, 0.001), 2e4}};
  scenes.push_back({"edge", ridge, {0.6, 0.8, 0}});
  return scenes;
}

Problem with_moved_obstacle(Problem problem, const Eigen::Vector3d& by) {
  obstacle::Body& body = problem.obstacles.front().body;
  body = body.transformed(-by, Eigen::Matrix3d::Identity(), 1);
  return problem;
}

// If an obstacle is moved, the energy at rest changes by the work of its contact force only,
// because the grips do not move.
TEST(SoftContact, EnergyGrowsByTheWorkOfAnObstacleThatIsMoved) {
  constexpr double h = 1e-4;
  for (const YieldingScene& scene : yielding_scenes()) {
    SCOPED_TRACE(scene.name);
    const Equilibrium here = test::converged(solve_energy(scene.problem));
    const Equilibrium ahead = solve_energy(with_moved_obstacle(scene.problem, h * scene.way));
    const Equilibrium behind = solve_energy(with_moved_obstacle(scene.problem, -h * scene.way));
    const double force = here.obstacles.front().dot(scene.way);
    ASSERT_GT(force, 0.1);
    EXPECT_GT(here.energy.contact, 0);
    EXPECT_NEAR((ahead.energy.total() - behind.energy.total()) / (2 * h), force, 1e-5 * force);
  }
}

// The peg is stiff and thin: its contact is a tenth of the distance between the arc lengths at
// which a shape is first sampled, wherever it is. By F = k (4/3) d (2 r d)^(1/2) its depth is 3e-6
// compared with 6e-4, so that its force is close to that of a rigid peg (to 1 %).
TEST(SoftContact, AThinPegIsDetectedBetweenTwoSamples) {
  constexpr double radius = 0.002;
  for (const double at : {0.4, 0.4007, 0.40125, 0.402}) {
    SCOPED_TRACE(at);
    Problem problem = heavy_cantilever(5, 0);
    const Eigen::Vector3d top =
        test::point_at(solve_energy(problem), at) + Eigen::Vector3d(0, 0.3 * radius, 0);
    problem.obstacles = {
        {obstacle::Body::cylinder(top - Eigen::Vector3d(0, radius, 0), {0, 0, 1}, radius)}};
    const Equilibrium rigid = test::converged(solve_energy(problem));
    problem.obstacles[0].stiffness = 1e8;
    const Equilibrium soft = test::converged(solve_energy(problem));
    EXPECT_EQ(soft.penetration, 0);  // only a rigid obstacle is penetrated, a soft one yields
    EXPECT_LT(soft.obstacles[0].y(), rigid.obstacles[0].y());
    EXPECT_NEAR(soft.obstacles[0].y() / rigid.obstacles[0].y(), 1, 0.01);
  }
}

/// Returns a rod with one clamp, or a clamp and a pin, and one obstacle that yields,
/// into which the rod would reach without it.
Problem random_scene(int seed) {
  using obstacle::Body;
  std::mt19937 random(static_cast<unsigned>(seed));
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  Problem problem = heavy_cantilever(std::pow(10, uniform(0.3, 1.7)), uniform(-40, 40));
  if (seed % 2 == 1) problem.grips.push_back({1, {uniform(0.5, 0.8), uniform(-0.3, 0.3), 0}});
  const Eigen::Matrix3Xd points =
      solve_energy(problem).sample(std::vector<double>{uniform(0.4, 0.7)}).points;
  const Eigen::Vector3d at = points.col(0);
  const double deep = uniform(0.01, 0.03);
  const double radius = uniform(0.08, 0.2);
  const double turned = uniform(-0.3, 0.3);
  const Eigen::Matrix3d axes =
      Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d below = at - Eigen::Vector3d(0, radius - deep, 0);
  const std::array<Body, 5> bodies = {
      Body::half_space(at + Eigen::Vector3d(0, deep, 0), axes.col(1)),
      Body::cylinder(below, {0, 0, 1}, radius), Body::sphere(below, radius),
      Body::capsule(below, axes.col(0), 0.1, radius),
      Body::box(below, axes, {0.3, 2 * radius, 0.3}, 0.5 * radius)};
  problem.obstacles = {
      {bodies[static_cast<std::size_t>(seed / 2) % bodies.size()], std::pow(10, uniform(2, 4))}};
  return problem;
}

/// Returns the rest shape after a temporary load has pushed the rod out of its plane.
Equilibrium relax_after_disturbance(const Problem& problem, const Equilibrium& shape) {
  Problem pushed = problem;
  pushed.loads = {{0.6, {0, 0, 0.01}}};
  const Equilibrium aside = solve_energy(pushed, {.start = &shape});
  return solve_energy(problem, {.start = &aside});
}

// The lowest equilibrium is stationary: if the obstacle is moved, only its contact force does work.
// The list contains no equilibrium twice. After a push out of the plane, in which a round obstacle
// can lose the rod, a stable one does not come to rest with less energy.
TEST(SoftContact, RandomScenesListEachEquilibriumOnceWithTheForceOfItsEnergy) {
  constexpr int scenes = 10;
  // The errors of the shapes change energies by about 1e-9.
  constexpr double h = 1e-5;
  const Eigen::Vector3d way(0, 1, 0);
  int pressed = 0;
  for (int seed = 0; seed < scenes; ++seed) {
    const Problem problem = random_scene(seed);
    const std::vector<Equilibrium> found = all_energy(problem);
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const std::vector<double> s = {0.25, 0.5, 0.75, 1};
        const double apart = (found[i].sample(s).points - found[j].sample(s).points).norm();
        EXPECT_GT(apart, 1e-4) << seed << ": " << i << " " << j << ", energies "
                               << found[i].energy.total() << " " << found[j].energy.total();
      }
    }
    for (const Equilibrium& state : found) {
      if (state.status != SolveStatus::converged) continue;
      const Equilibrium back = relax_after_disturbance(problem, state);
      if (back.status != SolveStatus::converged) continue;
      EXPECT_GT(back.energy.total(), state.energy.total() - 1e-6) << seed;
    }
    const Equilibrium& lowest = found.front();
    if (lowest.status != SolveStatus::converged) continue;
    EXPECT_LT(lowest.error_estimate, 1e-7) << seed;
    const double force = lowest.obstacles.front().dot(way);
    if (force == 0) continue;
    ++pressed;
    const EnergyOptions from{.start = &lowest};
    const Equilibrium ahead = solve_energy(with_moved_obstacle(problem, h * way), from);
    const Equilibrium behind = solve_energy(with_moved_obstacle(problem, -h * way), from);
    EXPECT_NEAR((ahead.energy.total() - behind.energy.total()) / (2 * h), force,
                1e-4 * std::max(1.0, std::abs(force)))
        << seed;
  }
  EXPECT_GE(pressed, scenes * 2 / 3);
}

/// In the middle plane of a deep box the forces to both sides are equal. The rod slides to one of
/// the sides, as it does if the box is slightly off the plane.
TEST(SoftContact, ARodInTheMiddlePlaneOfADeepBoxLeavesIt) {
  const auto solved = [](double aside) {
    Problem problem = heavy_cantilever(10, 0);
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    problem.obstacles = {
        {obstacle::Body::box({0.45, -0.3, aside}, axes, {0.6, 0.5, 0.08}, 0.02), 40}};
    return test::converged(solve_energy(problem));
  };
  const Equilibrium middle = solved(0);
  const Equilibrium beside = solved(1e-4);
  EXPECT_GT(std::abs(test::point_at(middle, 1).z()), 0.01);
  // The energies differ by the out-of-plane contact force times the displacement.
  EXPECT_NEAR(middle.energy.total(), beside.energy.total(),
              1.2e-4 * std::abs(middle.obstacles.at(0).z()));
}

/// The contact interval is shorter than the distance of nodes in a shape whose elements do not end
/// where contact ends.
TEST(SoftContact, WhatIsFollowedIsTheShapeThatItWas) {
  Problem problem = heavy_cantilever(15, 0);
  problem.grips = {{0, Eigen::Vector3d::Zero()}, {1, {0.58, -0.49, -0.25}}};
  problem.obstacles = {
      {obstacle::Body::cylinder({0.186, -0.561, -0.083}, {0.26, -0.03, 0.965}, 0.12), 8e5}};
  EnergySolver solver;
  const Equilibrium first = test::converged(solver.solve(problem));
  const Equilibrium again = solver.follow(problem);
  if (solver.followed()) {
    EXPECT_LT(test::largest_point_distance(again, first), 1e-6);
  }
  const Equilibrium started = test::converged(solve_energy(problem, {.start = &first}));
  EXPECT_NEAR(started.energy.total(), first.energy.total(), 1e-6);
}

}  // namespace
}  // namespace dlo::energy_model
