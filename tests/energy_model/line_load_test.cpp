// Tests of line loads: against the weight, beam theory and multiple shooting.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "../sanitized.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "equilibrium_balance.hpp"
#include "problems.hpp"
#include "random_problems.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

Problem with_weight_as_load(Problem problem) {
  problem.line_loads = {{0, 1, problem.weight_per_length, problem.weight_per_length}};
  problem.weight_per_length.setZero();
  return problem;
}

/// Returns the problem with one or two line loads, of 0.6 (1 + Gamma) at both ends, on the whole
/// rod or on parts of it.
Problem with_random_line_loads(Problem problem, std::uint64_t seed, bool planar) {
  RandomNumbers random(seed);
  const double size = 0.6 * (1 + problem.weight_per_length.norm());
  const RandomSpace space = planar ? RandomSpace::plane : RandomSpace::space;
  for (int i = 1 + random.below(2); i > 0; --i) {
    const double begin = random.chance(0.3) ? 0 : random.uniform(0, 0.6);
    const double end = random.chance(0.3) ? 1 : random.uniform(begin + 0.1, 1);
    const Eigen::Vector3d force = size * random.direction(space);
    problem.line_loads.push_back(
        {begin, end, force, random.chance(0.5) ? force : size * random.direction(space)});
  }
  return problem;
}

TEST(LineLoad, OnAllOfTheRodIsAWeight) {
  Problem tilted = heavy_cantilever(20, 30);
  tilted.loads = {{0.5, {1, 2, 3}}};
  for (const Problem& heavy : {heavy_cantilever(20, 30), two_clamps(10, 0.8), tilted}) {
    const Problem loaded = with_weight_as_load(heavy);
    for (const auto solve : test::solvers) {
      const Equilibrium one = solve(heavy);
      const Equilibrium other = test::converged(solve(loaded));
      EXPECT_EQ(test::largest_point_distance(one, other), 0);
      EXPECT_NEAR(other.energy.load, one.energy.gravity + one.energy.load, 1e-11 * 20);
      EXPECT_NEAR(other.energy.total(), one.energy.total(), 1e-12 * 20);
      EXPECT_EQ(one.grips[0].torque, other.grips[0].torque);
    }
  }
}

TEST(LineLoad, TendsToBeamTheoryWithTheSquareOfTheLoad) {
  // The tip sinks by int q(s) s^2 (3 - s) / 6 ds; here q grows from 0 at 0.2 to q at 0.7.
  constexpr double a = 0.2;
  constexpr double b = 0.7;
  const auto moment = [](double s) {  // int (s - a) s^2 (3 - s) / 6
    return (-std::pow(s, 5) / 5 + (3 + a) * std::pow(s, 4) / 4 - a * std::pow(s, 3)) / 6;
  };
  const double beam = (moment(b) - moment(a)) / (b - a);
  for (const auto solve : test::solvers) {
    double before = 0;
    for (const double q : {0.4, 0.2, 0.1}) {
      Problem problem = heavy_cantilever(0, 0);
      problem.line_loads = {{a, b, {0, 0, 0}, {0, -q, 0}}};
      const Equilibrium result = test::converged(solve(problem));
      const double error = 1 + test::point_at(result, 1).y() / (q * beam);
      if (before > 0) EXPECT_NEAR(before / error, 4, 0.02);
      before = error;
      EXPECT_LT(std::abs(error), 1e-3);
    }
  }
}

/// Expects that the reactions of the energy model's shape balance the loads if it has converged,
/// and that shooting has the same shape if it succeeds from there; then counts it in `confirmed`.
void expect_confirmed(const Problem& problem, int& confirmed) {
  const Equilibrium energy = solve_energy(problem);
  if (!succeeded(energy.status)) return;
  const double force = 1 + problem.weight_per_length.norm();
  double largest = force;
  for (const Reaction& grip : energy.grips) largest = std::max(largest, grip.force.norm());
  const double panel = std::min(0.02, 0.25 / std::sqrt(largest));
  EXPECT_LT(test::balance_of(problem, energy, panel).worst(), 1e-7);
  const Equilibrium exact = solve_exact(problem, {.start = &energy});
  if (!succeeded(exact.status)) return;
  ++confirmed;
  EXPECT_LT(test::largest_point_distance(energy, exact), 1e-8);
  EXPECT_NEAR(energy.energy.load, exact.energy.load, 1e-7 * force);
  EXPECT_NEAR(energy.energy.gravity, exact.energy.gravity, 1e-7 * force);
  for (std::size_t i = 0; i < energy.grips.size(); ++i) {
    const Eigen::Vector3d miss = energy.grips[i].force - exact.grips[i].force;
    EXPECT_LT(miss.norm(), 1e-5 * (force + exact.grips[i].force.norm()));
  }
}

TEST(LineLoad, EnergyAndShootingAgreeOnRandomScenes) {
  for (const RandomSpace space :
       {RandomSpace::plane, RandomSpace::space, RandomSpace::curved, RandomSpace::twisted}) {
    int confirmed = 0;
    const int all = space == RandomSpace::twisted ? 3 : 8;
    const int count = test::sanitized ? 1 : all;
    for (int i = 0; i < count; ++i) {
      const auto number = static_cast<std::uint64_t>(i);
      SCOPED_TRACE(test::name_of(space) + std::to_string(number));
      const bool planar = space == RandomSpace::plane;
      Problem problem = random_problem(number, space);
      // The forces are limited so that every problem is solved quickly.
      const double share = std::min(1.0, 30 / problem.weight_per_length.norm());
      problem.weight_per_length *= share;
      for (Load& load : problem.loads) load.force *= share;
      expect_confirmed(with_random_line_loads(problem, number, planar), confirmed);
    }
    if (test::sanitized) continue;
    EXPECT_GE(confirmed, count - 2) << test::name_of(space);
  }
}

TEST(LineLoad, ARodSeenFromItsOtherEndIsTheSame) {
  Problem problem = heavy_cantilever(5, 20);
  problem.line_loads = {{0.1, 0.6, {1, 2, 0}, {-3, 4, 0}}};
  Problem reversed = problem;
  reversed.grips[0].at = 1;
  *reversed.grips[0].direction *= -1;
  reversed.line_loads = {{0.4, 0.9, {-3, 4, 0}, {1, 2, 0}}};
  const std::vector<double> s = {0, 0.3, 1};
  const std::vector<double> back = {1, 0.7, 0};
  for (const auto solve : test::solvers) {
    const Equilibrium one = solve(problem);
    const Equilibrium other = test::converged(solve(reversed));
    EXPECT_LT((one.sample(s).points - other.sample(back).points).norm(), 1e-10);
  }
}

TEST(LineLoad, OfWhatIsNotOnTheRodIsRefused) {
  Problem problem = heavy_cantilever(1, 0);
  for (const LineLoad& wrong : {LineLoad{0.5, 0.5}, LineLoad{-0.1, 0.5}, LineLoad{0.5, 1.1},
                                LineLoad{0, 1, {NAN, 0, 0}, {0, 0, 0}}}) {
    problem.line_loads = {wrong};
    EXPECT_THROW((void)solve_energy(problem), std::invalid_argument);
    EXPECT_THROW((void)solve_exact(problem), std::invalid_argument);
  }
}

}  // namespace
}  // namespace dlo::energy_model
