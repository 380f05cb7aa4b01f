// Tests of rods that may pass a body on either side.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "contact_samples.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "problems.hpp"
#include "random_contact.hpp"
#include "rolled_clamps.hpp"
#include "solved.hpp"
#include "start_along.hpp"

namespace dlo::energy_model {
namespace {

using obstacle::Body;

using Corners = std::vector<Eigen::Vector3d>;

/// Returns energy_near() from points on the polyline through `corners`.
Equilibrium solve_near_polyline(const Problem& problem, const Corners& corners) {
  const std::vector<double> s = equal_arc_lengths(problem.length, 21);
  return energy_near(problem, s, test::start_along_polyline(corners).sample(s).points);
}

/// Returns the solution of `exact` from an equilibrium with its contacts.
Equilibrium confirmed(const Problem& problem, const Equilibrium& rod) {
  test::expect_only_pushed(problem, rod);
  return test::converged(solve_exact(problem, {.start = &rod}));
}

/// Returns the stable equilibrium of a list that is the same as another one to 1e-6; null: there is
/// none.
const Equilibrium* find_stable(const std::vector<Equilibrium>& list, const Equilibrium& wanted) {
  const auto found = std::find_if(list.begin(), list.end(), [&](const Equilibrium& other) {
    return succeeded(other.status) && test::largest_point_distance(other, wanted) < 1e-6;
  });
  return found == list.end() ? nullptr : &*found;
}

/// Returns a rope from a pin to the left of a peg, with a load at its end.
Problem rope_beside_peg() {
  Problem problem = heavy_cantilever(4e3, 0);
  problem.grips = {{0, {-0.4, 0.07, 0}}};
  problem.loads = {{1, {0, -6e4, 0}}};
  problem.obstacles = {{Body::cylinder({0, 0, 0}, {0, 0, 1}, 0.06)}};
  return problem;
}

/// Returns a rod above two compliant cylinders; its weight presses it onto both.
Problem rod_above_yielding_circles() {
  Problem problem = heavy_cantilever(200, 10);
  problem.obstacles = {{Body::cylinder({0.3, -0.08, 0}, {0, 0, 1}, 0.06), 2e5},
                       {Body::cylinder({0.75, -0.2, 0}, {0, 0, 1}, 0.08), 2e5}};
  return problem;
}

/// Returns a rod that rises from its clamp, with a block in its way.
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

// A temporary load moves the rod to either side of a body, and the rod stays there. The equilibrium
// that a search without this load finds has no more energy.
TEST(SidesOfBodies, WhatIsFoundCostsNoMoreThanWhatALoadLeadsTo) {
  constexpr int scenes = 100;
  int compared = 0;
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
      ++compared;
      EXPECT_LE(found.energy.total(), left.energy.total() + 1e-6) << seed << ", pulled by " << pull;
    }
  }
  EXPECT_GE(compared, 3 * scenes);
}

// EI kappa^2 / 2 + n.t + w.r is the same all along, whatever frictionless body the rod lies on; at
// a pin and at a free end kappa is zero.
TEST(SidesOfBodies, ARopeNearPointsOverAPegLiesOnIt) {
  const Problem problem = rope_beside_peg();
  const Equilibrium rod = test::converged(solve_near_polyline(
      problem, {{-0.4, 0.07, 0}, {0.02, 0.08, 0}, {0.08, 0, 0}, {0.08, -0.45, 0}}));
  ASSERT_EQ(rod.contacts.size(), 1);
  EXPECT_EQ(rod.contacts[0].kind, ContactKind::lying);
  const Samples ends = rod.sample(std::array{0.0, 1.0});
  const Eigen::Vector3d fall = ends.points.col(1) - ends.points.col(0);
  const double held = -rod.grips[0].force.dot(ends.tangents.col(0));
  const double pulled = problem.loads[0].force.dot(ends.tangents.col(1));
  EXPECT_NEAR(held, pulled + problem.weight_per_length.dot(fall), 1e-7 * held);
  EXPECT_LT(test::largest_point_distance(rod, confirmed(problem, rod)), 1e-7);
  // Next to the peg the rope hangs lower, and a search for the lowest equilibrium finds this shape.
  const Equilibrium lowest = test::converged(solve_energy(problem));
  EXPECT_TRUE(lowest.contacts.empty());
  EXPECT_LT(lowest.energy.total(), rod.energy.total());
  const EnergySearch search = search_energy(problem);
  EXPECT_NE(find_stable(search.equilibria, rod), nullptr);
  EXPECT_NE(find_stable(search.equilibria, lowest), nullptr);
  const auto past = std::find_if(
      search.strategies.begin(), search.strategies.end(), [](const SearchStrategy& strategy) {
        return strategy.name.find("pass one or two obstacles") != std::string::npos;
      });
  ASSERT_NE(past, search.strategies.end());
  EXPECT_EQ(past->tried, 2);
  EXPECT_EQ(past->new_equilibria, 1);
}

TEST(SidesOfBodies, ACantileverStaysOnTheSideOfItsPoints) {
  Problem problem = heavy_cantilever(4, 0);
  const Eigen::Vector3d middle = test::point_at(solve_energy(problem), 0.6);
  problem.obstacles = {{Body::cylinder(middle, {0, 0, 1}, 0.05)}};
  double lowest = std::numeric_limits<double>::infinity();
  const std::vector<Equilibrium> all = all_energy(problem);
  for (const double side : {1.0, -1.0}) {
    SCOPED_TRACE(side);
    const Eigen::Vector3d beside(0, side * 0.06, 0);
    const Eigen::Vector3d tip(0.95, middle.y() - 0.15, 0);
    const Equilibrium rod = test::converged(
        solve_near_polyline(problem, {{0, 0, 0}, {0.2, 0, 0}, middle + beside, tip + beside}));
    ASSERT_EQ(rod.contacts.size(), 1);
    EXPECT_GT(side * rod.contacts[0].force.y(), 0);
    EXPECT_LT(test::largest_point_distance(rod, confirmed(problem, rod)), 1e-7);
    EXPECT_NE(find_stable(all, rod), nullptr);
    lowest = std::min(lowest, rod.energy.total());
  }
  EXPECT_NEAR(solve_energy(problem).energy.total(), lowest, 1e-9);
}

TEST(SidesOfBodies, ARodThatLiesOnYieldingCirclesIsListed) {
  const Problem problem = rod_above_yielding_circles();
  const Equilibrium rod = test::converged(
      solve_near_polyline(problem, {{0, 0, 0}, {0.3, -0.01, 0}, {0.75, -0.1, 0}, {0.98, -0.3, 0}}));
  for (const Eigen::Vector3d& force : rod.obstacles) EXPECT_GT(force.y(), 1);
  const Eigen::Vector3d sum = rod.obstacles[0] + rod.obstacles[1] + rod.grips[0].force;
  EXPECT_LT((sum + problem.weight_per_length).norm(), 1e-8 * problem.weight_per_length.norm());
  EXPECT_NE(find_stable(all_energy(problem), rod), nullptr);
}

/// Expects that energy_near() finds every known stable equilibrium from its own points.
void expect_found_from_own_points(const Problem& problem, const std::string& name) {
  const std::vector<double> s = equal_arc_lengths(problem.length, 41);
  for (const Equilibrium& known : all_energy(problem)) {
    if (known.status != SolveStatus::converged) continue;
    const Equilibrium near = energy_near(problem, s, known.sample(s).points);
    EXPECT_EQ(near.status, SolveStatus::converged) << name << ": " << near.message;
    if (near.status != SolveStatus::converged) continue;
    EXPECT_LT(test::largest_point_distance(near, known), 1e-6)
        << name << ", " << known.energy.total();
  }
}

TEST(SidesOfBodies, AStableEquilibriumIsFoundNearItsOwnPoints) {
  expect_found_from_own_points(test::two_clamps(10, 0.6), "two clamps");
  Problem pins = heavy_cantilever(20, 0);
  pins.grips = {{0.1, {0, 0, 0}}, {0.8, {0.4, 0.1, 0}}};
  expect_found_from_own_points(pins, "two pins");
  expect_found_from_own_points(test::framed_clamps(5, 0.7, 0.8, 7), "twisted");
  for (const bool space : {false, true}) {
    for (unsigned seed = 0; seed < 6; ++seed) {
      const std::optional<Problem> scene = test::random_problem_with_body(seed, space);
      if (scene) expect_found_from_own_points(*scene, "seed " + std::to_string(seed));
    }
  }
}

TEST(SidesOfBodies, RefusesPointsThatAreNoShape) {
  const Problem problem = heavy_cantilever(1, 0);
  const Eigen::Matrix3Xd points = Eigen::Matrix3d::Identity();
  EXPECT_NO_THROW((void)energy_near(problem, {0, 0.5, 1}, points));
  EXPECT_THROW((void)energy_near(problem, {0, 1}, points), std::invalid_argument);
  EXPECT_THROW((void)energy_near(problem, {0, 0.5, 0.5}, points), std::invalid_argument);
  EXPECT_THROW((void)energy_near(problem, {0, 0.5, 1.1}, points), std::invalid_argument);
  EXPECT_THROW((void)energy_near(problem, {0.5}, points.leftCols(1)), std::invalid_argument);
  EXPECT_THROW((void)energy_near(problem, {0, 0.5, 1}, NAN * points), std::invalid_argument);
  EXPECT_THROW((void)energy_near(problem, {0, 0.5, 1}, 0 * points), std::invalid_argument);
}

TEST(SidesOfBodies, InThePlaneOfTheRodAreNeitherSideOfACylinderWithItsAxisThere) {
  Problem problem = heavy_cantilever(40, 0);
  problem.obstacles = {{Body::cylinder({0, -0.3, 0}, {1, 0, 0}, 0.05)}};
  EXPECT_EQ(test::converged(solve_energy(problem)).other_side_starts, 0);
}

TEST(SidesOfBodies, DoNotDependOnPointsOfARefusedProblem) {
  const Problem problem = heavy_cantilever(5, 0);
  Problem refused = problem;
  refused.axial_stiffness = 100;
  EnergySolver solver;
  EXPECT_THROW((void)solver.near(refused, {0, 0.5, 1}, Eigen::Matrix3d::Identity()),
               std::invalid_argument);
  const Equilibrium later = solver.solve(problem);
  const Equilibrium first = solve_energy(problem);
  EXPECT_EQ(later.message, first.message);
  EXPECT_EQ(later.energy.total(), first.energy.total());
}

}  // namespace
}  // namespace dlo::energy_model
