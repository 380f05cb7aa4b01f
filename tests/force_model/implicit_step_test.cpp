// Tests of implicit steps: their shapes at rest, the number of solves, the motion behind a gripper
// and on walls, and steps in real time.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "dlo/force_model/batch.hpp"
#include "dlo/force_model/simulation.hpp"
#include "dlo/force_model/tangent_stiffness.hpp"
#include "oscillation.hpp"
#include "rods.hpp"
#include "twisted_rods.hpp"

namespace dlo::force_model {
namespace {

using std::numbers::pi;

StepOptions implicit_options() { return {.policy = policy(Stepper::implicit)}; }

/// Steel a hundred times softer, with its own stretch stiffness: Gamma = 18.
struct SoftRod : SteelRod {
  explicit SoftRod(int count) {
    points = count;
    EI /= 100;
    AE /= 100;
  }
  [[nodiscard]] Rod rod() const { return SteelRod::rod({BendingLaw::hooke, EI}, AE); }
};

Wall floor_at(double height, double stiffness) {
  return {.point = {0, height, 0}, .normal = {0, 1, 0}, .stiffness = stiffness};
}

/// A rod, where it starts, and what is special about it.
struct ImplicitCase {
  std::string name;
  Rod rod;
  Eigen::Matrix3Xd start;
};

std::vector<ImplicitCase> implicit_cases() {
  const SteelRod steel;
  const Rod hooke = steel.rod({BendingLaw::hooke, steel.EI}, steel.AE);
  std::vector<ImplicitCase> result;
  result.push_back({"hooke, c_c = AE", hooke, steel.straight()});
  result.push_back(
      {"paper, c_c = 660", steel.rod({BendingLaw::paper, 3574.96}, 660), steel.straight()});
  SoftRod soft(16);
  soft.AE = 660;
  result.push_back({"soft", soft.rod(), soft.straight()});
  result.push_back({"on springs", soft.rod(), soft.straight()});
  result.back().rod.grips[0].hold = GripHold::spring;
  result.back().rod.grips[0].stiffness = 1000;
  result.push_back({"on a floor", soft.rod(), soft.straight()});
  result.back().rod.walls = {floor_at(-0.1, 100)};
  result.push_back({"over a ball", soft.rod(), soft.straight()});
  result.back().rod.solids = {
      {.body = obstacle::Body::sphere({0.25, -0.1, 0}, 0.05), .stiffness = 100, .samples = 4}};
  result.push_back({"between two clamps", soft.rod(), soft.straight()});
  Rod& two = result.back().rod;
  two.grips.push_back({.first_point = 14,
                       .targets = grip_targets({0.35, 0.02, 0.03}, {1, 0.2, 0}, soft.segment(),
                                               soft.segment() / 2)});
  Eigen::Matrix3Xd& bent = result.back().start;
  for (int i = 0; i < 16; ++i) {
    const double share = i / 15.0;
    bent.col(i) << 0.35 * share, -0.15 * std::sin(pi * share), 0.03 * share;
  }
  return result;
}

TEST(ImplicitStepper, RestsWhereTheAutomaticStepperDoes) {
  for (const ImplicitCase& one : implicit_cases()) {
    Simulation simulation(one.rod, one.start, implicit_options());
    const RelaxResult result = simulation.relax({.tolerance = 1e-9});
    ASSERT_EQ(result.status, RelaxStatus::at_rest) << one.name << ": " << result.message;
    EXPECT_LT(result.remaining_error, 1e-9 * one.rod.length()) << one.name;
    // From nearby, as there may be several equilibria.
    Simulation automatic(one.rod, simulation.points() + 1e-3 * (one.start - simulation.points()),
                         {});
    const RelaxResult other = automatic.relax({.tolerance = 1e-8});
    ASSERT_EQ(other.status, RelaxStatus::at_rest) << one.name;
    EXPECT_LT(rms_distance(simulation.points(), automatic.points()),
              other.remaining_error + result.remaining_error + 1e-13)
        << one.name;
  }
}

TEST(ImplicitStepper, BringsASoftRodToRestInTenSolvesWhateverItsPoints) {
  for (const int points : {16, 32, 200}) {
    const SoftRod soft(points);
    Simulation reference(soft.rod(), soft.straight(), implicit_options());
    const RelaxResult rest = reference.relax({.tolerance = 1e-9});
    ASSERT_EQ(rest.status, RelaxStatus::at_rest);
    EXPECT_LE(rest.steps, 10) << points;
    Simulation simulation(soft.rod(), soft.straight(), implicit_options());
    while (simulation.steps() < 5) ASSERT_EQ(simulation.step().status, StepStatus::good);
    EXPECT_LT(rms_distance(simulation.points(), reference.points()), 1e-3 * soft.length) << points;
    while (simulation.steps() < 7) ASSERT_EQ(simulation.step().status, StepStatus::good);
    EXPECT_LT(rms_distance(simulation.points(), reference.points()), 1e-7 * soft.length) << points;
  }
}

TEST(ImplicitStepper, DoesTheSameInEveryFrameOfReference) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  const Eigen::Vector3d shift(0.2, -0.1, 0.3);
  const auto moved = [&](const Eigen::Matrix3Xd& points) -> Eigen::Matrix3Xd {
    return (turn * points).colwise() + shift;
  };
  for (const ImplicitCase& one : implicit_cases()) {
    if (!one.rod.solids.empty()) continue;
    Rod rod = one.rod;
    rod.loads = turn * rod.loads;
    for (Grip& grip : rod.grips) grip.targets = moved(grip.targets);
    for (Wall& wall : rod.walls) {
      wall.point = moved(wall.point);
      wall.normal = turn * wall.normal;
    }
    Simulation here(one.rod, one.start, implicit_options());
    Simulation there(rod, moved(one.start), implicit_options());
    ASSERT_EQ(here.relax({.tolerance = 1e-9}).status, RelaxStatus::at_rest) << one.name;
    ASSERT_EQ(there.relax({.tolerance = 1e-9}).status, RelaxStatus::at_rest) << one.name;
    EXPECT_LT(rms_distance(moved(here.points()), there.points()), 1e-9) << one.name;
  }
}

TEST(ImplicitStepper, MovesARestingRodWithItsGripperInOneSolve) {
  const SoftRod soft(32);
  Simulation simulation(soft.rod(), soft.straight(), implicit_options());
  ASSERT_EQ(simulation.relax({.tolerance = 1e-10}).status, RelaxStatus::at_rest);
  const Eigen::Matrix3Xd rest = simulation.points();
  const Eigen::Vector3d way(0.3, 0.4, -1.2);
  const long before = simulation.steps();
  const Eigen::Matrix3Xd targets = rest.leftCols(2).colwise() + way;
  simulation.move_grip(0, targets, way);
  ASSERT_EQ(simulation.step().status, StepStatus::good);
  EXPECT_EQ(simulation.steps() - before, 1);
  // Rounding of the positions displaces the slowest mode, before the movement and after it.
  const double rounding = check_equilibrium(simulation.rod(), simulation.points()).rounding_error;
  EXPECT_LT(rounding, 1e-7 * soft.length);
  EXPECT_LT(rms_distance(simulation.points(), rest.colwise() + way),
            1e-10 * soft.length + 2 * rounding);
}

/// A gripper that moves and turns, as that of dlo bench does: error of every twentieth frame, RMS
/// over the length.
TEST(ImplicitStepper, FollowsAGripperWithinAMillionthOfTheLengthByOneSolveAFrame) {
  const SoftRod soft(32);
  Simulation simulation(soft.rod(), soft.straight(), implicit_options());
  ASSERT_EQ(simulation.relax().status, RelaxStatus::at_rest);
  const long before = simulation.steps();
  constexpr int frames = 100;
  for (int frame = 1; frame <= frames; ++frame) {
    const double way = 1e-4 * frame;
    const double angle = way / soft.length;
    simulation.move_grip(0,
                         grip_targets({way, 0, 0}, {std::cos(angle), std::sin(angle), 0},
                                      soft.segment(), soft.segment() / 2),
                         {way, 0, 0});
    ASSERT_EQ(simulation.step().status, StepStatus::good);
    if (frame % 20 != 0) continue;
    Simulation rest = simulation;
    ASSERT_EQ(rest.relax({.tolerance = 1e-9}).status, RelaxStatus::at_rest);
    EXPECT_LT(rms_distance(simulation.points(), rest.points()), 1e-6 * soft.length) << frame;
  }
  EXPECT_EQ(simulation.steps() - before, frames);
}

TEST(ImplicitStepper, ArrivesWithAGripperThatJumpsAndTurnsRound) {
  const SoftRod soft(16);
  Simulation simulation(soft.rod(), soft.straight(), implicit_options());
  ASSERT_EQ(simulation.relax().status, RelaxStatus::at_rest);
  const Eigen::Matrix3Xd targets =
      grip_targets({0, 0.5, 0}, {-1, 0, 0}, soft.segment(), soft.segment() / 2);
  simulation.move_grip(0, targets, {0, 0.5, 0});
  ASSERT_EQ(simulation.step().status, StepStatus::good);
  EXPECT_EQ(simulation.points().leftCols(2), targets);
  ASSERT_EQ(simulation.relax().status, RelaxStatus::at_rest);
  // The shape at rest does not depend on the path to it.
  Rod turned = soft.rod();
  turned.grips[0].targets = targets;
  Eigen::Matrix3Xd straight = soft.straight();
  straight.row(0) *= -1;
  straight.row(1).array() += 0.5;
  Simulation direct(turned, straight, implicit_options());
  ASSERT_EQ(direct.relax().status, RelaxStatus::at_rest);
  EXPECT_LT(rms_distance(simulation.points(), direct.points()), 2e-7 * soft.length);
}

TEST(ImplicitStepper, LeavesABalancedRodStandingOnlyWhereItIsStable) {
  // An upright rod buckles under its own weight at Gamma = 7.837; that of the polygon is near.
  for (const double gamma : {7.0, 9.0}) {
    SteelRod steel;
    steel.angle = pi / 2;
    steel.weight_per_length = gamma * steel.EI / std::pow(steel.length, 3);
    Simulation simulation(steel.rod({BendingLaw::hooke, steel.EI}, steel.AE), steel.straight(),
                          implicit_options());
    ASSERT_EQ(simulation.relax().status, RelaxStatus::at_rest) << gamma;
    const double aside = std::abs(simulation.points()(0, 15)) / steel.length;
    if (gamma < 8) {
      EXPECT_LT(aside, 1e-6);
    } else {
      EXPECT_GT(aside, 0.1);
    }
  }
}

TEST(ImplicitStepper, GoesThroughTimeWithFirstOrder) {
  const test::Oscillation oscillation;
  const auto error = [&](int steps) { return oscillation.error(Stepper::implicit, steps); };
  const double coarse = error(800);
  const double fine = error(1600);
  EXPECT_LT(coarse, 0.1);
  EXPECT_NEAR(coarse / fine, 2, 0.1);
}

TEST(ImplicitStepper, StaysStableWithTimeStepsFarBeyondTheFastestMode) {
  const SoftRod soft(32);
  Rod rod = soft.rod();
  rod.masses = -rod.loads.row(1).transpose() / 9.81;
  rod.walls = {floor_at(-0.2, soft.AE / soft.segment())};
  StepOptions options = implicit_options();
  options.time_step = 0.01;
  options.damping_rate = 10;
  Simulation simulation(rod, soft.straight(), options);
  double lowest_y = 0;
  for (int i = 0; i < 300; ++i) {
    ASSERT_EQ(simulation.step().status, StepStatus::good);
    lowest_y = std::min(lowest_y, simulation.points().row(1).minCoeff());
  }
  EXPECT_GT(lowest_y, -0.205);
  ASSERT_EQ(simulation.relax({.tolerance = 1e-6}).status, RelaxStatus::at_rest);
  Simulation rest(rod, soft.straight(), implicit_options());
  ASSERT_EQ(rest.relax().status, RelaxStatus::at_rest);
  EXPECT_LT(rms_distance(simulation.points(), rest.points()), 2e-6 * soft.length);
}

TEST(ImplicitStepper, RefusesWhatItCannotDo) {
  const SteelRod steel;
  const Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  EXPECT_THROW(Batch({{rod, steel.straight(), implicit_options()}}), std::invalid_argument);
  StepOptions in_time = implicit_options();
  in_time.time_step = 1e-3;
  EXPECT_THROW(Simulation(rod, steel.straight(), in_time), std::invalid_argument);  // no masses
  for (const double wrong : {0.0, -1.0, std::nan("")}) {
    StepOptions options = implicit_options();
    options.time_step = wrong;
    EXPECT_THROW(Simulation(rod, steel.straight(), options), std::invalid_argument) << wrong;
    options = in_time;
    options.damping_rate = wrong - 1;
    EXPECT_THROW(Simulation(rod, steel.straight(), options), std::invalid_argument) << wrong;
  }
  test::TwistedRod twisted;
  twisted.turn = 1;
  EXPECT_THROW(Simulation(twisted.rod(), twisted.arch(), implicit_options()),
               std::invalid_argument);
}

}  // namespace
}  // namespace dlo::force_model
