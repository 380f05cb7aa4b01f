#include "dlo/force_model/simulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "rods.hpp"

namespace dlo::force_model {
namespace {

Rod steel_rod(double c_c = 660) {
  const SteelRod steel;
  return steel.rod({BendingLaw::hooke, steel.EI}, c_c);
}

StepOptions options(Stepper stepper, double c_F, double l_s = 1e-4, double c_h = 0) {
  StepOptions result;
  result.policy = policy(stepper);
  result.c_F = c_F;
  result.l_s = l_s;
  result.c_h = c_h;
  return result;
}

Eigen::Matrix3Xd forces_on_free_points(const Simulation& simulation) {
  Eigen::Matrix3Xd forces(3, simulation.points().cols());
  total_forces(simulation.rod(), simulation.points(), forces);
  forces.leftCols(2).setZero();
  return forces;
}

TEST(LimitedStepper, ScalesTheLargestMovementDownToTheLimit) {
  const double l_s = 1e-9;
  Simulation simulation(steel_rod(), SteelRod().straight(), options(Stepper::limited, 1e-5, l_s));
  const Eigen::Matrix3Xd before = simulation.points();
  const double d_m =
      std::sqrt((1e-5 * forces_on_free_points(simulation)).colwise().squaredNorm().maxCoeff());
  ASSERT_GT(d_m, l_s);
  const StepResult result = simulation.step();
  EXPECT_TRUE(result.limited);
  EXPECT_DOUBLE_EQ(result.c_m, l_s / d_m);  // (17)
  const double moved = std::sqrt((simulation.points() - before).colwise().squaredNorm().maxCoeff());
  EXPECT_NEAR(moved, l_s, 1e-6 * l_s + 1e-16);
  EXPECT_EQ(simulation.limited_steps(), 1);
}

TEST(DynamicStepper, AddsAShareOfTheLastMovement) {
  Simulation simulation(steel_rod(), SteelRod().straight(),
                        options(Stepper::dynamic, 1e-5, 1e-2, 0.8));
  const Eigen::Matrix3Xd start = simulation.points();
  (void)simulation.step();
  const Eigen::Matrix3Xd first = simulation.points() - start;
  const Eigen::Matrix3Xd expected =
      simulation.points() + 0.8 * first + 1e-5 * forces_on_free_points(simulation);  // (19)
  (void)simulation.step();
  EXPECT_LT((simulation.points() - expected).cwiseAbs().maxCoeff(), 1e-16);
}

TEST(OscillationDamping, LeavesOutMovementsOfRoundingSize) {
  SteelRod hanging;
  hanging.angle = -1.5707963267948966;
  for (const double c_h : {0.0, 0.9}) {
    Simulation simulation(hanging.rod({BendingLaw::hooke, hanging.EI}, 660), hanging.straight(),
                          options(Stepper::dynamic, 1e-5, 1e-2, c_h));
    for (int i = 0; i < 50000; ++i) ASSERT_EQ(simulation.step().status, StepStatus::good);
    EXPECT_EQ(simulation.damped_steps(), 0) << "c_h = " << c_h;
  }
}

TEST(OscillationDamping, GrowsWhilePointsTurnBackAndFallsToOneAfterwards) {
  // 2.2 times the stable step: the contraction modes turn back in every step.
  const double c_F = 2.2 / mode_bounds(steel_rod(), SteelRod().straight()).fastest * 2;
  Eigen::Matrix3Xd start = SteelRod().straight();
  start(0, 8) += 1e-4;
  Simulation simulation(steel_rod(), start, options(Stepper::limited, c_F, 1e-3));
  double smallest = 1;
  for (int i = 0; i < 200; ++i) {
    const StepResult result = simulation.step();
    ASSERT_EQ(result.status, StepStatus::good);
    smallest = std::min(smallest, result.c_m);
  }
  EXPECT_LT(smallest, 0.9);
  EXPECT_GT(simulation.damped_steps(), 0);
  EXPECT_LT(simulation.damped_steps(), 200);
}

TEST(CatchUpLoop, RepeatsUntilTheSumOfScalingsIsReached) {
  Simulation simulation(steel_rod(), SteelRod().straight(), options(Stepper::limited, 1e-5, 2e-8));
  const StepResult last = simulation.advance(10);
  EXPECT_EQ(last.status, StepStatus::good);
  EXPECT_GT(simulation.steps(), 10);  // movements were scaled down, so more steps were needed
  Simulation free(steel_rod(), SteelRod().straight(), options(Stepper::basic, 1e-5));
  (void)free.advance(10);
  EXPECT_EQ(free.steps(), 10);
}

TEST(CatchUpLoop, ReportsTheRemainderWhenItsStepsAreUsedUp) {
  Simulation simulation(steel_rod(), SteelRod().straight(), options(Stepper::basic, 1e-5));
  EXPECT_EQ(simulation.advance(1000, 3).status, StepStatus::behind);
  EXPECT_EQ(simulation.steps(), 3);
  EXPECT_EQ(simulation.remaining_steps(), 997);
  const Simulation copy(simulation);
  EXPECT_EQ(copy.remaining_steps(), 997);
  EXPECT_EQ(simulation.advance(3, 1000).status, StepStatus::good);
  EXPECT_EQ(simulation.steps(), 1003);
  EXPECT_EQ(simulation.remaining_steps(), 0);
  // The status is the same if no step is allowed at all.
  EXPECT_EQ(simulation.advance(2, 0).status, StepStatus::behind);
  EXPECT_EQ(simulation.remaining_steps(), 2);
}

TEST(CatchUpLoop, CarriesTheOvershootToTheNextCall) {
  Simulation simulation(steel_rod(), SteelRod().straight(), options(Stepper::basic, 1e-5));
  for (int i = 0; i < 10; ++i) (void)simulation.advance(0.5);
  EXPECT_EQ(simulation.steps(), 5);
}

TEST(Simulation, ACopyContinuesLikeTheOriginalAndDoesNotChangeIt) {
  const StepOptions dynamic = options(Stepper::dynamic, 1e-5, 1e-4, 0.9);
  Simulation original(steel_rod(), SteelRod().straight(), dynamic);
  for (int i = 0; i < 50; ++i) (void)original.step();
  const Eigen::Matrix3Xd before = original.points();
  const Simulation constructed(original);
  Simulation assigned(steel_rod(1), SteelRod().straight(), dynamic);
  assigned = constructed;
  for (int i = 0; i < 50; ++i) (void)assigned.step();
  EXPECT_EQ((original.points() - before).norm(), 0);
  EXPECT_EQ((constructed.points() - before).norm(), 0);
  for (int i = 0; i < 50; ++i) (void)original.step();
  // The momentum of the last step has been copied as well.
  EXPECT_EQ((original.points() - assigned.points()).norm(), 0);
  EXPECT_GT((original.points() - before).norm(), 0);
  assigned = std::move(original);
  EXPECT_EQ(assigned.steps(), 100);
}

TEST(Relax, ReportsRestStepLimitAndDivergence) {
  Simulation rests(steel_rod(), SteelRod().straight(), {});
  const RelaxResult good = rests.relax();
  EXPECT_EQ(good.status, RelaxStatus::at_rest);
  EXPECT_LT(good.remaining_error, 1e-7 * 0.5);
  Simulation stopped(steel_rod(), SteelRod().straight(), {});
  const RelaxResult limited = stopped.relax({.max_steps = 50});
  EXPECT_EQ(limited.status, RelaxStatus::step_limit);
  EXPECT_EQ(limited.steps, 50);
  EXPECT_GT(limited.remaining_error, 1e-7 * 0.5);
  Simulation wild(steel_rod(), SteelRod().straight(), options(Stepper::basic, 1));
  EXPECT_EQ(wild.relax().status, RelaxStatus::diverged);
}

TEST(Relax, CreepingIsNotRest) {
  // A slow basic stepper moves by less than 1e-9 m a step and is still millimetres from rest.
  Simulation creeping(steel_rod(), SteelRod().straight(), options(Stepper::basic, 1e-7));
  const RelaxResult result = creeping.relax({.tolerance = 1e-5, .max_steps = 20000});
  EXPECT_EQ(result.status, RelaxStatus::step_limit);
  EXPECT_GT(result.remaining_error, 1e-5);
}

TEST(Relax, IsNotFooledByManyPointsOrFastModes) {
  // With many points the first steps only excite the fastest modes; the rod has hardly fallen.
  SteelRod steel;
  steel.points = 400;
  Simulation simulation(steel.rod({BendingLaw::hooke, steel.EI}, 660), steel.straight(), {});
  const RelaxResult result = simulation.relax({.max_steps = 2000});
  EXPECT_EQ(result.status, RelaxStatus::step_limit);
  EXPECT_GT(result.remaining_error, 1e-3);
}

TEST(Relax, FindsRestBetweenModesThatAreFarApart) {
  // fastest / slowest = 1e11, as of 500 points: rounding's forces are larger than the rod's own.
  SteelRod steel;
  const Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 1e9);
  Simulation simulation(rod, steel.straight(), {});
  const RelaxResult result = simulation.relax({.tolerance = 1e-5, .max_steps = 4'000'000});
  RecordProperty("steps", static_cast<int>(result.steps));
  EXPECT_EQ(result.status, RelaxStatus::at_rest);
  Simulation reference(steel.rod({BendingLaw::hooke, steel.EI}, 1e4), steel.straight(), {});
  ASSERT_EQ(reference.relax().status, RelaxStatus::at_rest);
  // The reference is softer in tension than the simulated rod and stretches by up to weight / c_c =
  // 1.2e-5.
  EXPECT_LT((simulation.points() - reference.points()).colwise().norm().maxCoeff(),
            4e-5 * steel.length);
}

TEST(Relax, LeavesAnUnstableUprightEquilibrium) {
  SteelRod steel;
  steel.angle = 1.5707963267948966;
  const double gamma_unit = steel.weight_per_length * 0.125;  // w l^3: EI = gamma_unit / Gamma
  for (const double gamma : {6.0, 20.0}) {
    const Rod rod = steel.rod({BendingLaw::hooke, gamma_unit / gamma}, 660);
    Simulation simulation(rod, steel.straight(), {});
    ASSERT_EQ(simulation.relax().status, RelaxStatus::at_rest) << gamma;
    const double tip_x = simulation.points()(0, 15);
    if (gamma < 7.8) {
      EXPECT_LT(std::abs(tip_x), 1e-5);
    } else {
      EXPECT_GT(tip_x, 0.3 * steel.length);
    }
  }
}

TEST(Relax, BucklesAColumnBetweenGripsThatStayWhereTheyAre) {
  SteelRod steel;
  Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  rod.loads.setZero();
  Eigen::Matrix3Xd start = steel.straight();
  const Eigen::Index end = start.cols() - 1;
  for (Eigen::Index i = 0; i <= end; ++i) {
    start.col(i) = start.col(0) + 0.95 * (start.col(i) - start.col(0));
  }
  Grip far;
  far.first_point = end - 1;
  far.targets = start.rightCols(2);
  far.reference = start.col(end);
  rod.grips.push_back(far);
  Simulation simulation(rod, start, {});
  ASSERT_EQ(simulation.relax().status, RelaxStatus::at_rest);
  const Eigen::Matrix3Xd moved = simulation.points() - start;
  EXPECT_GT(moved.colwise().norm().maxCoeff(), 0.05 * steel.length);
  EXPECT_EQ(moved.rightCols(2).norm(), 0);
}

class StepsToRest : public testing::TestWithParam<double> {};

/// Steps after which every point stays within 1e-4 l of the rest shape.
long steps_to_rest(double c_c, double angle) {
  SteelRod steel;
  steel.angle = angle;
  const Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, c_c);
  Simulation reference(rod, steel.straight(), {});
  const RelaxResult rest = reference.relax({.tolerance = 1e-8});
  EXPECT_EQ(rest.status, RelaxStatus::at_rest);
  Simulation simulation(rod, steel.straight(), {});
  long last_outside = 0;
  for (long i = 1; i <= rest.steps; ++i) {
    EXPECT_EQ(simulation.step().status, StepStatus::good);
    const double distance =
        std::sqrt((simulation.points() - reference.points()).colwise().squaredNorm().maxCoeff());
    if (distance > 1e-4 * steel.length) last_outside = i;
  }
  return last_outside + 1;
}

TEST_P(StepsToRest, StayBelowTheirLimits) {
  const double angle = GetParam() * 3.14159265358979323846 / 180;
  const long soft = steps_to_rest(660, angle);
  const long physical = steps_to_rest(SteelRod().AE, angle);
  RecordProperty("steps_c_c_660", static_cast<int>(soft));
  RecordProperty("steps_c_c_AE", static_cast<int>(physical));
  EXPECT_LE(soft, 2500);
  EXPECT_LE(physical, 60000);
}

INSTANTIATE_TEST_SUITE_P(Angles, StepsToRest, testing::Values(0.0, -135.0, -175.0, -215.0),
                         [](const auto& instance) {
                           return "minus" + std::to_string(static_cast<int>(-instance.param));
                         });

TEST(Simulation, MovedGripperTakesItsPointsAlong) {
  Simulation simulation(steel_rod(), SteelRod().straight(), {});
  const Eigen::Matrix3Xd targets =
      grip_targets({0, 0.1, 0}, {1, 0, 0}, SteelRod().segment(), SteelRod().segment() / 2);
  simulation.move_grip(0, targets, {0, 0.1, 0});
  EXPECT_EQ(simulation.points().leftCols(2), targets);
  EXPECT_EQ(simulation.relax().status, RelaxStatus::at_rest);
  EXPECT_THROW(simulation.move_grip(1, targets, {0, 0, 0}), std::invalid_argument);
}

TEST(Relax, LeavesThePlaneIfAShapeIsStableInItOnly) {
  // A tall arch, up from one clamp and down into the other, heavy enough to lean over sideways.
  const Eigen::Index n = 31;
  const double L = 1.0 / (n - 2);
  const double radius = 0.05;
  const double height = (1 - std::numbers::pi * radius) / 2;
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double s = (static_cast<double>(i) - 0.5) * L;
    const double turned = std::clamp((s - height) / radius, 0.0, std::numbers::pi);
    points(0, i) = radius * (1 - std::cos(turned));
    points(1, i) = std::min(s, height) + radius * std::sin(turned) -
                   std::max(0.0, s - height - std::numbers::pi * radius);
  }
  Rod rod;
  rod.rest_lengths = Eigen::VectorXd::Constant(n - 1, L);
  rod.c_c = 1e4;
  rod.bending = {BendingLaw::hooke, 1};
  rod.loads = Eigen::Vector3d(0, -200 * L, 0).replicate(1, n);
  rod.grips = {{.first_point = 0, .targets = points.leftCols(2)},
               {.first_point = n - 2, .targets = points.rightCols(2)}};
  Simulation simulation(rod, points, {});
  ASSERT_EQ(simulation.relax({.tolerance = 1e-6}).status, RelaxStatus::at_rest);
  EXPECT_GT(simulation.points().row(2).cwiseAbs().maxCoeff(), 0.1);
}

TEST(Simulation, SpringGripYieldsByWeightOverStiffness) {
  SteelRod steel;
  steel.angle = -1.5707963267948966;
  Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  rod.grips.front().hold = GripHold::spring;
  rod.grips.front().stiffness = 50;
  Simulation simulation(rod, steel.straight(), {});
  ASSERT_EQ(simulation.relax({.tolerance = 1e-9}).status, RelaxStatus::at_rest);
  const double weight = steel.weight_per_length * steel.length;
  const GripReaction reaction = grip_reactions(rod, simulation.points()).front();
  EXPECT_NEAR(reaction.force.y(), weight, 1e-7);
  // Each of the gripper's two springs carries half of the weight on average.
  const Eigen::Matrix3Xd yielded = rod.grips.front().targets - simulation.points().leftCols(2);
  EXPECT_NEAR(yielded.row(1).mean(), weight / 2 / 50, 1e-9);
  EXPECT_LT(yielded.row(0).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Simulation, MovedWallLeadsToTheShapeOfAWallThatWasThere) {
  const SteelRod steel;
  Rod rod = steel.rod({BendingLaw::hooke, steel.EI / 100}, 660);
  rod.walls = {{.point = {0, -0.05, 0}, .normal = {0, 1, 0}, .stiffness = 1000}};
  const Wall moved{.point = {0, -0.03, 0}, .normal = {0, 1, 0}, .stiffness = 500};
  const RelaxOptions exact{.tolerance = 1e-9};
  Simulation simulation(rod, steel.straight(), {});
  ASSERT_EQ(simulation.relax(exact).status, RelaxStatus::at_rest);
  simulation.move_wall(0, moved);
  ASSERT_EQ(simulation.relax(exact).status, RelaxStatus::at_rest);
  rod.walls = {moved};
  Simulation expected(rod, steel.straight(), {});
  ASSERT_EQ(expected.relax(exact).status, RelaxStatus::at_rest);
  const Eigen::Matrix3Xd apart = simulation.points() - expected.points();
  EXPECT_LT(apart.norm() / 4, 2 * 1e-9 * steel.length);  // 4: root of 16 points, RMS
}

TEST(Simulation, AutomaticStepsSuitAStifferWallAtOnce) {
  const SteelRod steel;
  Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  rod.walls = {{.point = {0, 0, 0}, .normal = {0, 1, 0}, .stiffness = 0}};
  Simulation simulation(rod, steel.straight(), {});
  for (int i = 0; i < 5; ++i) ASSERT_EQ(simulation.step().status, StepStatus::good);
  simulation.move_wall(0, {.point = {0, 0.001, 0}, .normal = {0, 1, 0}, .stiffness = 1e7});
  const double fastest = mode_bounds(simulation.rod(), simulation.points()).fastest;
  EXPECT_GE(fastest, 1e7);
  EXPECT_LE(simulation.options().c_F, largest_step_factor(fastest, simulation.options().c_h));
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(simulation.step().status, StepStatus::good);
  EXPECT_LT(simulation.points().cwiseAbs().maxCoeff(), 2 * steel.length);
}

TEST(Simulation, RefusesToMoveAWallThatIsNotThere) {
  Rod rod = steel_rod();
  rod.walls = {{.stiffness = 1}};
  Simulation simulation(rod, SteelRod().straight(), {});
  EXPECT_THROW(simulation.move_wall(1, {}), std::invalid_argument);
  EXPECT_THROW(simulation.move_wall(0, {.normal = {0, 2, 0}}), std::invalid_argument);
  EXPECT_THROW(simulation.move_wall(0, {.stiffness = -1}), std::invalid_argument);
}

TEST(Simulation, RefusesMissingConstants) {
  EXPECT_THROW(Simulation(steel_rod(), SteelRod().straight(), options(Stepper::basic, 0)),
               std::invalid_argument);
  EXPECT_THROW(Simulation(steel_rod(), SteelRod().straight(), options(Stepper::limited, 1, 0)),
               std::invalid_argument);
  EXPECT_THROW(Simulation(steel_rod(), SteelRod().straight(), options(Stepper::dynamic, 1, 1, 1)),
               std::invalid_argument);
  EXPECT_THROW(Simulation(steel_rod(), Eigen::Matrix3Xd::Zero(3, 4), {}), std::invalid_argument);
  Eigen::Matrix3Xd points = SteelRod().straight();
  points(2, 2) = NAN;
  EXPECT_THROW(Simulation(steel_rod(), points, {}), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::force_model
