// Tests of rods that grips stretch nearly to their length, with forces up to 1e7 EI/l^2: that such
// problems are solved, with the tension that follows from their slack.

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "../says.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "problem/segments.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// Returns a rod with a clamp at an angle to the chord, and a clamp or a pin at the other end. The
/// distance of the grips is l minus `slack`.
Problem rod_with_slack(double slack, double first, double last, bool pinned) {
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.weight_per_length = {0, -2, 0.3};
  problem.grips.resize(2);
  problem.grips[0].direction = Eigen::Vector3d(std::cos(first), std::sin(first), 0);
  problem.grips[1].at = 1;
  problem.grips[1].position = {1 - slack, 0, 0};
  if (!pinned) problem.grips[1].direction = Eigen::Vector3d(std::cos(last), 0, std::sin(last));
  return problem;
}

Span span_of_problem(const Problem& problem) {
  Span span;
  span.planar = false;
  span.start_direction = problem.grips[0].direction;
  span.end_direction = problem.grips[1].direction;
  span.holds = {{1, problem.grips[1].position}};
  span.weight = problem.weight_per_length;
  return span;
}

/// Clamps exactly l apart along x.
Problem taut_between_clamps() {
  Problem problem;
  problem.length = 2;
  problem.bending_stiffness = 1;
  problem.torsional_stiffness = 0.8;
  problem.grips = {{0, {1, 2, 3}, Eigen::Vector3d::UnitX(), {}},
                   {2, {3, 2, 3}, Eigen::Vector3d(5, 0, 0), {}}};
  return problem;
}

TEST(TautLine, IsStraightAndTwistsAsTwoSpringsInBothModels) {
  Problem problem = taut_between_clamps();
  problem.sections = {{0.5, 1, 1, 0.2, {0, 0, 0}}};
  problem.grips[0].frame = FrameHold{Eigen::Vector3d::UnitY(), 0.25};
  problem.grips[1].frame = FrameHold{Eigen::Vector3d::UnitZ(), 7};  // d1 is a quarter turn ahead
  const double angle = std::acos(-1.0) / 2 + 7 - 0.25;
  const double torque = angle / (1.5 / 0.8 + 0.5 / 0.2);
  for (const Equilibrium& solved : {solve_energy(problem), solve_exact(problem)}) {
    ASSERT_EQ(solved.status, SolveStatus::converged) << solved.message;
    const Samples samples = solved.sample(std::vector<double>{0, 0.5, 2});
    EXPECT_LT((samples.points.col(1) - Eigen::Vector3d(1.5, 2, 3)).norm(), 1e-15);
    EXPECT_TRUE(samples.curvature.isZero(0));
    EXPECT_EQ(solved.energy.bending, 0);
    EXPECT_NEAR(solved.energy.twisting, angle * torque / 2, 1e-12);
    EXPECT_NEAR(solved.grips[1].torque.x(), torque, 1e-12);
    EXPECT_NEAR(solved.grips[0].torque.x(), -torque, 1e-12);
    ASSERT_EQ(solved.twists.size(), 1U);
    EXPECT_NEAR(solved.twists[0].angle, angle, 1e-12);
    const auto d1_at = [](double turned) {
      return Eigen::Vector3d(0, std::cos(turned), std::sin(turned));
    };
    EXPECT_LT((samples.d1.col(0) - d1_at(0.25)).norm(), 1e-12);
    EXPECT_LT((samples.d1.col(1) - d1_at(0.25 + torque * 0.5 / 0.8)).norm(), 1e-12);
    EXPECT_LT((samples.d1.col(2) - d1_at(0.25 + angle)).norm(), 1e-12);
  }
}

TEST(TautLine, IsTheLimitOfVanishingSlack) {
  Problem problem = taut_between_clamps();
  problem.grips[0].frame = FrameHold{Eigen::Vector3d::UnitY(), 0};
  problem.grips[1].frame = FrameHold{Eigen::Vector3d::UnitY(), 2};
  const Equilibrium taut = solve_energy(problem);
  double before = 0;
  for (const double slack : {1e-4, 1e-6}) {
    problem.grips[1].position.x() = 3 - 2 * slack;
    const Equilibrium solved = test::require_usable(solve_energy(problem));
    EXPECT_EQ(std::signbit(solved.twists[0].torque), std::signbit(taut.twists[0].torque));
    const double away = std::abs(solved.grips[1].torque.x() - taut.grips[1].torque.x());
    EXPECT_LT(away, 10 * std::sqrt(slack));
    if (before > 0) EXPECT_LT(away, before);
    before = away;
    EXPECT_LT((test::point_at(solved, 1) - test::point_at(taut, 1)).norm(), 2 * std::sqrt(slack));
  }
}

TEST(TautLine, CarriesWhatActsAlongItAsAnUnstressedBar) {
  Problem problem = taut_between_clamps();
  problem.weight_per_length = {-3, 0, 0};
  problem.loads = {{0.5, {8, 0, 0}}, {2, {1, 1, 1}}};  // across it at a grip alone
  problem.grips.push_back({1.5, {2.5, 2, 3}, std::nullopt, std::nullopt});
  const Equilibrium solved = test::converged(solve_energy(problem));
  EXPECT_NEAR(solved.grips[0].force.x(), 3 * 0.75 - 8 * 2.0 / 3, 1e-12);
  EXPECT_NEAR(solved.grips[2].force.x(), 3 * 1.0 - 8 / 3.0, 1e-12);
  EXPECT_LT((solved.grips[1].force - Eigen::Vector3d(3 * 0.25 - 1, -1, -1)).norm(), 1e-12);
  EXPECT_NEAR(solved.energy.gravity, 3 * 2 * 1.0, 1e-12);
  EXPECT_NEAR(solved.energy.load, -8 * 0.5 - 2, 1e-12);
}

// A load per length that grows from -1 to 3 N/m over 2 m puts 2 (-1) / 3 + 2 (3) / 6 = 1/3 N on the
// first grip of a bar and 2 (-1) / 6 + 2 (3) / 3 = 5/3 N on the second; its work is
// int (2 s - 1) s ds = 2^4 / 3 - 2.
TEST(TautLine, CarriesALineLoadThatGrows) {
  Problem problem = taut_between_clamps();
  problem.line_loads = {{0, 2, {-1, 0, 0}, {3, 0, 0}}};
  for (const Equilibrium& solved : {solve_energy(problem), solve_exact(problem)}) {
    ASSERT_EQ(solved.status, SolveStatus::converged) << solved.message;
    EXPECT_NEAR(solved.grips[0].force.x(), -1.0 / 3, 1e-14);
    EXPECT_NEAR(solved.grips[1].force.x(), -5.0 / 3, 1e-14);
    EXPECT_NEAR(solved.energy.load, -(16.0 / 3 - 2), 1e-13);
    EXPECT_NEAR(solved.energy.gravity, 0, 1e-14);
  }
  problem.line_loads[0].at_end = {3, 0.1, 0};
  EXPECT_THROW((void)solve_energy(problem), std::invalid_argument);
}

TEST(TautLine, LeavesACoupleOnAClampToThatClamp) {
  Problem problem = taut_between_clamps();
  problem.loads = {{2, {0, 1, 0}, {0, 0.3, 2}}, {0, {0, 0, 0}, {0, 0, -1}}};
  const Equilibrium solved = test::converged(solve_energy(problem));
  EXPECT_EQ(solved.grips[1].torque, Eigen::Vector3d(0, -0.3, -2));
  EXPECT_EQ(solved.grips[0].torque, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(solved.grips[1].force, Eigen::Vector3d(0, -1, 0));
  problem.loads.pop_back();
  problem.loads[0].torque.y() = 0;
  const Equilibrium shot = test::converged(solve_exact(problem));
  EXPECT_EQ(shot.grips[1].torque, Eigen::Vector3d(0, 0, -2));
}

// The forces of the grips against such a couple depend on the tension, which the problem does not
// determine.
TEST(TautLine, RefusesACoupleThatNoClampTakes) {
  Problem inside = taut_between_clamps();
  inside.loads = {{1, {0, 0, 0}, {0, 0, 1e-3}}};
  Problem on_pin = taut_between_clamps();
  on_pin.grips[1].direction.reset();
  on_pin.loads = {{2, {0, 0, 0}, {0, 0, 1e-3}}};
  for (const Problem& problem : {inside, on_pin}) {
    for (const bool exact : {false, true}) {
      const std::string error = test::error_of<std::invalid_argument>(
          [&] { return exact ? solve_exact(problem) : solve_energy(problem); });
      EXPECT_TRUE(test::has_all(error, {"couple on a taut rod"}));
    }
  }
}

TEST(TautLine, IsRefusedIfNoTensionHoldsItStraight) {
  const auto refused = [](const Problem& problem) {
    EXPECT_THROW((void)solve_energy(problem), std::invalid_argument);
    EXPECT_THROW((void)solve_exact(problem), std::invalid_argument);
  };
  Problem problem = taut_between_clamps();
  problem.weight_per_length = {0, -1, 0};
  refused(problem);
  problem = taut_between_clamps();
  problem.loads = {{1, {0, 0, 1}}};
  refused(problem);
  problem = taut_between_clamps();
  problem.grips[1].direction = Eigen::Vector3d(1, 1e-3, 0);
  refused(problem);
  problem.grips[1].direction = Eigen::Vector3d(-1, 0, 0);
  refused(problem);
  problem = taut_between_clamps();
  problem.grips[1].position.x() += 1e-9;
  refused(problem);
}

TEST(Taut, TensionFollowsFromTheSlack) {
  int taut = 0;
  for (const double slack : {1e-2, 1e-3}) {
    for (const double angle : {0.5, 1.5, 3.0}) {
      for (const bool pinned : {false, true}) {
        const Problem problem = rod_with_slack(slack, angle, -0.8, pinned);
        const Equilibrium solved = test::converged(solve_energy(problem));
        const std::vector<Segment> segments = segments_of(span_of_problem(problem));
        ASSERT_EQ(segments.size(), 1U);
        if (!segments[0].taut()) continue;
        ++taut;
        const Eigen::Vector3d pull = solved.grips[1].force;
        // The estimate adds the effects of bending layers and sag as if they were independent. Its
        // error is proportional to the layers' part of the length.
        const double tolerance = 1.5 / std::sqrt(pull.norm());
        EXPECT_NEAR(segments[0].tension, pull.norm(), tolerance * pull.norm())
            << slack << ", " << angle << ", " << pinned;
        EXPECT_LT((segments[0].pull - pull.normalized()).norm(), tolerance);
      }
    }
  }
  EXPECT_GE(taut, 8);
}

TEST(Taut, IsSolvedUpToTensionsOfTenMillion) {
  for (const double slack : {1e-2, 1e-3, 5e-4}) {
    for (const double angle : {0.1, 1.5, 3.0}) {
      const Problem problem = rod_with_slack(slack, angle, -2.5, false);
      const Equilibrium solved = test::converged(solve_energy(problem));
      EXPECT_GT(solved.smallest_eigenvalue, 0);
      const Samples ends = solved.sample(std::vector<double>{0, 1});
      EXPECT_LT((ends.points.col(1) - problem.grips[1].position).norm(), 1e-10);
    }
  }
}

TEST(Taut, AgreesWithMultipleShooting) {
  const Problem problem = rod_with_slack(5e-3, 1.2, 0.7, false);
  const Equilibrium energy = test::converged(solve_energy(problem));
  const Equilibrium exact = test::converged(solve_exact(problem));
  EXPECT_LT(test::largest_point_distance(energy, exact, equal_arc_lengths(1, 101)), 1e-9);
  EXPECT_LT((energy.grips[0].force - exact.grips[0].force).norm(),
            1e-7 * exact.grips[0].force.norm());
}

}  // namespace
}  // namespace dlo::energy_model
