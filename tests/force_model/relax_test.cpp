// Tests that a rod that is reported `at rest` hardly moves in many further steps.

#include "dlo/force_model/relax.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "dlo/force_model/simulation.hpp"
#include "dlo/force_model/tangent_stiffness.hpp"
#include "rods.hpp"

namespace dlo::force_model {
namespace {

struct Start {
  Rod rod;
  Eigen::Matrix3Xd points;
};

/// Returns the start of a rod of 1 m and about 1 N between two pins; it sags and is a little out of
/// the plane. @param apart  distance of the pins [m]
Start between_pins(Eigen::Index points, double apart, double c_c, const Bending& bending) {
  Start start;
  const auto segments = static_cast<double>(points - 1);
  start.rod.rest_lengths = Eigen::VectorXd::Constant(points - 1, 1 / segments);
  start.rod.c_c = c_c;
  start.rod.bending = bending;
  start.rod.loads = Eigen::Vector3d(0, -1 / segments, 0).replicate(1, points);
  start.points.setZero(3, points);
  for (Eigen::Index i = 0; i < points; ++i) {
    const double s = static_cast<double>(i) / segments;
    const double sag = std::sqrt(std::max(0.0, 1 - apart * apart)) / 2;
    start.points.col(i) << apart * s, -4 * sag * s * (1 - s), 0.02 * std::sin(9 * s);
  }
  start.rod.grips = {{.first_point = 0, .targets = start.points.leftCols(1)},
                     {.first_point = points - 1, .targets = start.points.rightCols(1)}};
  return start;
}

/// Compares the shape after relax() with that after four times as many further steps.
void expect_rest(const Start& start, const std::string& what, double tolerance = 1e-7) {
  Simulation simulation(start.rod, start.points, {});
  const RelaxResult result = simulation.relax({.tolerance = tolerance});
  ASSERT_EQ(result.status, RelaxStatus::at_rest) << what;
  const Eigen::Matrix3Xd claimed = simulation.points();
  for (long i = 0; i < 4 * result.steps; ++i) (void)simulation.step();
  const double error = rms_distance(claimed, simulation.points());
  EXPECT_LT(error, tolerance * start.rod.length()) << what;
  EXPECT_LT(result.remaining_error, tolerance * start.rod.length()) << what;
  // remaining_error is 0.9 to 5 times the error, up to the error that remains after the further
  // steps.
  EXPECT_LT(error, 1.1 * result.remaining_error + 1e-11) << what;
  EXPECT_GT(error, 0.2 * result.remaining_error - 1e-11) << what;
}

TEST(AtRest, HoldsForARopeThatOnlyItsTensionKeepsFromSwinging) {
  expect_rest(between_pins(33, 0.8, 1e4, {BendingLaw::hooke, 0}), "rope");
}

TEST(AtRest, HoldsForRandomRopesAndRods) {
  std::mt19937 engine(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 12; ++i) {
    const auto points = static_cast<Eigen::Index>(8 + 20 * uniform(engine));
    const double apart = 0.2 + 0.75 * uniform(engine);
    const double c_c = std::pow(10, 2 + 2 * uniform(engine));
    const double EI = i % 3 == 0 ? 0 : std::pow(10, -5 + 4 * uniform(engine));
    const bool paper = i % 3 == 2;
    const Bending bending{paper ? BendingLaw::paper : BendingLaw::hooke, paper ? 100 * EI : EI};
    Start start = between_pins(points, apart, c_c, bending);
    for (double& L : start.rod.rest_lengths) L *= 0.9 + 0.2 * uniform(engine);
    start.rod.loads(2, points / 2) = uniform(engine) - 0.5;
    if (i % 4 == 0) start.rod.grips.pop_back();
    if (i % 4 == 1) start.rod.walls = {{.point = {0, -0.2, 0}, .stiffness = 100}};
    if (i % 4 == 2) {
      start.rod.grips.back().hold = GripHold::spring;
      start.rod.grips.back().stiffness = 50;
    }
    expect_rest(start, "rod " + std::to_string(i), 1e-6);
  }
}

TEST(AtRest, IsReachedByTheAutomaticStepperWithAThousandPoints) {
  Start start = between_pins(1000, 0.8, 10, {BendingLaw::hooke, 1e-7});
  Simulation simulation(start.rod, start.points, {});
  const RelaxResult result = simulation.relax({.tolerance = 1e-5, .max_steps = 400'000});
  RecordProperty("steps", static_cast<int>(result.steps));
  ASSERT_EQ(result.status, RelaxStatus::at_rest);
  // Half the weight hangs on each pin.
  const GripReaction reaction = grip_reactions(start.rod, simulation.points()).front();
  EXPECT_NEAR(reaction.force.y(), 500.0 / 999, 1e-3);
  EquilibriumCheck check = check_equilibrium(start.rod, simulation.points());
  Eigen::Matrix3Xd refined = simulation.points();
  for (int i = 0; i < 5; ++i) {
    refined += check.step;
    check = check_equilibrium(start.rod, refined);
  }
  ASSERT_LT(check.remaining_error, 1e-11);
  EXPECT_LT(rms_distance(simulation.points(), refined), 1e-5);
}

TEST(AtRest, IsClaimedForARodThatTurnsFreelyAndSaysSo) {
  // A column that has buckled between two pins, without weight: it turns about their line.
  Start start = between_pins(17, 0.9, 1e3, {BendingLaw::hooke, 0.1});
  start.rod.loads.setZero();
  Simulation simulation(start.rod, start.points, {});
  const RelaxResult result = simulation.relax();
  ASSERT_EQ(result.status, RelaxStatus::at_rest);
  EXPECT_EQ(result.message, "at rest, except for 1 movement without stiffness");
  EXPECT_EQ(check_equilibrium(start.rod, simulation.points()).neutral_modes, 1);
}

TEST(AtRest, IsNotClaimedWhereRoundingHidesWhatBendsTheRod) {
  // There are so many points that the rounding error of a step's force exceeds the weight of one
  // point. The straight initial shape therefore seems to be without force.
  Start start = between_pins(100'001, 1, 1e3, {BendingLaw::hooke, 1e-3});
  start.points.row(2).setZero();
  const EquilibriumCheck check = check_equilibrium(start.rod, start.points);
  EXPECT_FALSE(check.stable && check.proven);
}

TEST(AtRest, IsNotClaimedWhereAMovementHasNoStiffnessButAForce) {
  // A rope without bending stiffness and weight, straight and free at its end, with a force across
  // it at this end.
  Start start = between_pins(5, 1, 1e3, {BendingLaw::hooke, 0});
  start.rod.grips.pop_back();
  start.rod.loads.setZero();
  start.rod.loads(1, 4) = 1e-6;
  for (Eigen::Index i = 0; i < 5; ++i) start.points.col(i) << 0.25 * static_cast<double>(i), 0, 0;
  const EquilibriumCheck check = check_equilibrium(start.rod, start.points);
  EXPECT_FALSE(check.stable && check.proven && check.remaining_error < 1e-3);
}

/// Newton's method from next to rest: each step squares the error if the stiffness is exact. The
/// paper's law has no potential between segments of unequal length, as stretched ones are; without
/// the skew part of its stiffness a step leaves some percent. One step may leave 0.1 % of the error
/// (hooke) or 5 % (paper).
void expect_quadratic_convergence(const Start& start, const std::string& what) {
  Simulation simulation(start.rod, start.points, {});
  ASSERT_EQ(simulation.relax({.tolerance = 1e-6}).status, RelaxStatus::at_rest) << what;
  Eigen::Matrix3Xd points = simulation.points();
  for (int i = 0; i < 3; ++i) points += check_equilibrium(start.rod, points).step;
  for (Eigen::Index i = 0; i < points.size(); ++i) {
    points.reshaped()[i] += 1e-8 * std::sin(3.7 * static_cast<double>(i));
  }
  for (const Grip& grip : start.rod.grips) {
    if (grip.hold == GripHold::rigid) {
      points.middleCols(grip.first_point, grip.targets.cols()) = grip.targets;
    }
  }
  const EquilibriumCheck first = check_equilibrium(start.rod, points);
  ASSERT_TRUE(first.stable) << what;
  EXPECT_TRUE(first.proven) << what;
  const EquilibriumCheck second = check_equilibrium(start.rod, points + first.step);
  const double left = start.rod.bending.law == BendingLaw::hooke ? 1e-3 : 0.05;
  EXPECT_LT(second.remaining_error, left * first.remaining_error) << what;
}

TEST(EquilibriumCheck, ItsStiffnessIsExactForBothLawsAndEverySpring) {
  for (const BendingLaw law : {BendingLaw::hooke, BendingLaw::paper}) {
    const std::string name = law == BendingLaw::hooke ? "hooke" : "paper";
    Start start = between_pins(12, 0.5, 100, {law, law == BendingLaw::hooke ? 0.01 : 1.0});
    expect_quadratic_convergence(start, name);
    start.rod.rest_lengths[4] *= 1.5;
    start.rod.loads(2, 7) = 0.2;
    if (law == BendingLaw::hooke) expect_quadratic_convergence(start, name + ", unequal");
    start.rod.rest_lengths[4] /= 1.5;
    start.rod.walls = {{.point = {0, -0.1, 0}, .normal = {0.6, 0.8, 0}, .stiffness = 100}};
    start.rod.grips.back().hold = GripHold::spring;
    start.rod.grips.back().stiffness = 20;
    expect_quadratic_convergence(start, name + ", wall and spring");
  }
}

TEST(Relax, StopsAtItsLimitOfTimeAndSaysSo) {
  const SteelRod steel;
  const Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  Simulation simulation(rod, steel.straight(), {});
  // The clock is looked at every 64 steps; the way to rest takes some thousand.
  const RelaxResult result =
      simulation.relax({.max_steps = std::numeric_limits<long>::max(), .time_limit = 1e-7});
  EXPECT_EQ(result.status, RelaxStatus::time_limit);
  EXPECT_EQ(result.message, "time limit");
  EXPECT_EQ(result.steps, simulation.steps());
  EXPECT_GE(result.remaining_error, 0);
  const RelaxResult interrupted = simulation.relax({.interrupted = [] { return true; }});
  EXPECT_EQ(interrupted.status, RelaxStatus::time_limit);
  EXPECT_EQ(interrupted.steps, 64);
  EXPECT_THROW((void)simulation.relax({.time_limit = 0}), std::invalid_argument);
  EXPECT_THROW((void)simulation.relax({.time_limit = NAN}), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::force_model
