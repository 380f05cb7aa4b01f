// Tests of couples: the arcs into which they bend a rod, balance, the energy against shooting, and
// the message if they have no potential.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "dlo/energy_model/dynamics.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "dlo/energy_model/vibrations.hpp"
#include "equilibrium_balance.hpp"
#include "problems.hpp"
#include "random_problems.hpp"
#include "rolled_clamps.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

Problem with_couple(Problem problem, double at, double torque) {
  problem.loads.push_back({at, {0, 0, 0}, {0, 0, torque}});
  return problem;
}

TEST(Couple, AtTheTipRollsTheRodIntoAnArc) {
  for (const double lambda : {0.8, 2.0, -1.3, 3.5}) {
    const double torque = lambda * pi;  // and the arc's angle
    for (const auto solve : test::solvers) {
      const Equilibrium result =
          test::converged(solve(with_couple(heavy_cantilever(0, 0), 1, torque)));
      EXPECT_NE(result.message.find("in the plane alone"), std::string::npos) << result.message;
      const std::vector<double> s = {0.25, 1};
      const Samples shape = result.sample(s);
      for (Eigen::Index i = 0; i < 2; ++i) {
        const double angle = torque * s[static_cast<std::size_t>(i)];
        EXPECT_NEAR(shape.points(0, i), std::sin(angle) / torque, 1e-11);
        EXPECT_NEAR(shape.points(1, i), (1 - std::cos(angle)) / torque, 1e-11);
      }
      EXPECT_NEAR(result.energy.bending, torque * torque / 2, 1e-9);
      EXPECT_NEAR(result.energy.load, -torque * torque, 1e-9);
      EXPECT_NEAR(result.grips[0].torque.z(), -torque, 1e-9);
    }
  }
}

TEST(Couple, SeenFromTheOtherEndIsTheSame) {
  Problem problem = with_couple(heavy_cantilever(5, 20), 0.6, 4);
  problem.loads[0].force = {1, 2, 0};
  Problem reversed = problem;
  reversed.grips[0].at = 1;
  *reversed.grips[0].direction *= -1;
  reversed.loads[0].at = 0.4;
  const std::vector<double> s = {0, 0.3, 1};
  const std::vector<double> back = {1, 0.7, 0};
  const Equilibrium one = solve_energy(problem);
  for (const auto solve : test::solvers) {
    const Equilibrium other = test::converged(solve(reversed));
    EXPECT_LT((one.sample(s).points - other.sample(back).points).norm(), 1e-9);
    EXPECT_NEAR(other.energy.load, one.energy.load, 1e-9);
    EXPECT_LT((other.grips[0].torque - one.grips[0].torque).norm(), 1e-8);
  }
}

TEST(Couple, EnergyFindsWhatShootingFindsOnRandomCantilevers) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 15; ++seed) {
    SCOPED_TRACE(seed);
    RandomNumbers random(seed);
    Problem problem = heavy_cantilever(random.uniform(0, 15), random.uniform(-180, 180));
    for (int i = 1 + random.below(2); i > 0; --i) {
      const double at = random.chance(0.4) ? 1 : random.uniform(0.1, 1);
      problem = with_couple(problem, at, random.uniform(-6, 6));
      const Eigen::Vector3d force = random.direction(test::RandomSpace::plane);
      if (random.chance(0.5)) problem.loads.back().force = 5 * random.uniform() * force;
    }
    const Equilibrium energy = solve_energy(problem);
    if (!succeeded(energy.status)) continue;
    EXPECT_LT(test::balance_of(problem, energy, 0.02).worst(), 1e-7);
    const std::vector<Equilibrium> all = all_exact(problem);
    ASSERT_FALSE(all.empty());
    const bool among = std::any_of(all.begin(), all.end(), [&](const Equilibrium& exact) {
      return succeeded(exact.status) && test::largest_point_distance(energy, exact) < 1e-8 &&
             std::abs(energy.energy.total() - exact.energy.total()) < 1e-8;
    });
    EXPECT_TRUE(among) << energy.message;
    found += among ? 1 : 0;
  }
  EXPECT_GE(found, 14);
}

TEST(Couple, BetweenClampsShootingConfirmsTheEnergysShape) {
  Problem clamps = two_clamps(10, 0.8);
  Problem pins = two_clamps(10, 0.8);
  for (Grip& grip : pins.grips) grip.direction.reset();
  Problem overhang = two_clamps(3, 0.6);
  overhang.grips[1].at = 0.7;
  Problem curved = two_clamps(10, 0.8);
  curved.natural_strains = {{0, 2, 0}};
  curved.torsional_stiffness = 0.8;
  for (const Problem& held : {clamps, pins, overhang, curved}) {
    const Problem problem = with_couple(held, 0.35, 3);
    const Equilibrium energy = test::require_usable(solve_energy(problem));
    EXPECT_LT(test::balance_of(problem, energy, 0.02).worst(), 1e-7);
    const Equilibrium exact = test::require_usable(solve_exact(problem, {.start = &energy}));
    EXPECT_LT(test::largest_point_distance(energy, exact), 1e-8);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_LT((energy.grips[i].torque - exact.grips[i].torque).norm(), 1e-6);
    }
    EXPECT_NEAR(energy.energy.load, exact.energy.load, 1e-8);
    EXPECT_NEAR(energy.energy.bending, exact.energy.bending, 1e-7);
  }
}

// Three clamps, a straight and a curved rod, which the energy model does not cut at the second one.
TEST(Couple, PotentialIsZeroInTheDirectionOfTheClampBefore) {
  for (const double natural : {0.0, 1.5}) {
    Problem problem = two_clamps(5, 0.8);
    if (natural != 0) {
      problem.natural_strains = {{0, natural, 0}};
      problem.torsional_stiffness = 0.8;
    }
    const Eigen::Vector3d tilted = Eigen::Vector3d(1, 0.4, 0).normalized();
    problem.grips.push_back({0.5, {0.42, 0.1, 0}, tilted});
    problem = with_couple(problem, 0.7, 1.5);
    const Equilibrium energy = test::require_usable(solve_energy(problem));
    const Equilibrium exact = test::require_usable(solve_exact(problem, {.start = &energy}));
    ASSERT_LT(test::largest_point_distance(energy, exact), 1e-8);
    const Eigen::Vector3d tangent = energy.sample(std::vector<double>{0.7}).tangents.col(0);
    const double angle = std::atan2(tilted.cross(tangent).z(), tilted.dot(tangent));
    EXPECT_NEAR(energy.energy.load, -1.5 * angle, 1e-9) << natural;
    EXPECT_NEAR(exact.energy.load, -1.5 * angle, 1e-8) << natural;
  }
}

// Two pins whose chord points forwards, aside or backwards: the angle is counted from the chord,
// within half a turn.
TEST(Couple, PotentialBetweenPinsIsCountedFromTheirChord) {
  for (const double degrees : {0.0, 100.0, 180.0, -120.0}) {
    const double angle = degrees * pi / 180;
    const Eigen::Vector3d chord(std::cos(angle), std::sin(angle), 0);
    Problem problem = two_clamps(0, 0.8);
    problem.grips[1].position = problem.grips[0].position + 0.8 * chord;
    for (Grip& grip : problem.grips) grip.direction.reset();
    problem = with_couple(problem, 0.35, 3);
    const Equilibrium energy = test::require_usable(solve_energy(problem));
    const Equilibrium exact = test::require_usable(solve_exact(problem, {.start = &energy}));
    const Samples at = energy.sample(std::vector<double>{0, 0.35});
    const Eigen::Vector3d first = at.tangents.col(0);
    const Eigen::Vector3d there = at.tangents.col(1);
    const double from_chord = std::atan2(chord.cross(first).z(), chord.dot(first)) +
                              std::atan2(first.cross(there).z(), first.dot(there));
    EXPECT_NEAR(energy.energy.load, -3 * from_chord, 1e-9) << degrees;
    EXPECT_NEAR(exact.energy.load, -3 * from_chord, 1e-7) << degrees;
  }
}

TEST(Couple, OutOfThePlaneIsForShootingAloneAndNotCalledStable) {
  Problem problem = heavy_cantilever(0, 0);
  constexpr double torque = 1e-3;
  problem.loads = {{1, {0, -1e-3, 0}, {0, torque, 0}}};
  EXPECT_THROW((void)solve_energy(problem), std::invalid_argument);
  const Equilibrium exact = solve_exact(problem);
  EXPECT_EQ(exact.status, SolveStatus::not_verified);
  EXPECT_NE(exact.message.find("not judged"), std::string::npos) << exact.message;
  EXPECT_NEAR(test::point_at(exact, 1).z(), -torque / 2, 1e-8);
  EXPECT_NEAR(test::point_at(exact, 1).y(), -1e-3 / 3, 1e-8);
  const std::vector<Equilibrium> all = all_exact(problem);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all.front().status, SolveStatus::not_verified);
  EXPECT_EQ(test::largest_point_distance(all.front(), exact), 0);
}

TEST(Couple, IsRefusedWhereItIsNotKnown) {
  const Problem framed = with_couple(test::framed_clamps(1, 0.8, 1, 0), 0.5, 1);
  EXPECT_THROW((void)solve_energy(framed), std::invalid_argument);
  Problem on_floor = with_couple(heavy_cantilever(1, 0), 1, 1);
  on_floor.obstacles = {{obstacle::Body::half_space({0, -0.1, 0}, Eigen::Vector3d::UnitY())}};
  EXPECT_THROW((void)solve_energy(on_floor), std::invalid_argument);
  EXPECT_THROW((void)solve_exact(on_floor), std::invalid_argument);
  const Problem problem = with_couple(heavy_cantilever(1, 0), 1, 1);
  const Equilibrium rest = solve_energy(problem);
  EXPECT_THROW((void)vibrations(problem, {.mass_per_length = 1}, rest), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::energy_model
