// Tests that steps allocate no memory, because a real-time loop must not wait for the allocator.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "../count_allocations.hpp"
#include "dlo/force_model/simulation.hpp"
#include "rods.hpp"
#include "twisted_rods.hpp"

#if defined(DLO_COUNTS_ALLOCATIONS)

namespace dlo::force_model {
namespace {

TEST(Simulation, StepsDoNotAllocate) {
  const test::SteelRod steel;
  Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  rod.walls = {{.point = {0, -0.01, 0}, .normal = {0, 1, 0}, .stiffness = 100}};
  for (const Stepper stepper : {Stepper::basic, Stepper::limited, Stepper::relative,
                                Stepper::dynamic, Stepper::automatic}) {
    StepOptions options;
    options.policy = policy(stepper);
    options.c_F = 1e-5;
    options.c_h = 0.5;
    options.l_s = 1e-3;
    Simulation simulation(rod, steel.straight(), options);
    const long before = allocations;
    for (int i = 0; i < 100; ++i) {
      if (simulation.step().status != StepStatus::good) break;
    }
    EXPECT_EQ(allocations, before) << "stepper " << static_cast<int>(stepper);
    EXPECT_EQ(simulation.steps(), 100);
  }
  // The counter detects an allocation.
  const long before = allocations;
  const Eigen::VectorXd vector = Eigen::VectorXd::Zero(steel.points);
  EXPECT_EQ(vector.size(), steel.points);
  EXPECT_GT(allocations, before);
}

TEST(Simulation, StepsInTimeAndImplicitOnesDoNotAllocate) {
  const test::SteelRod steel;
  Rod rod = steel.rod({BendingLaw::hooke, steel.EI / 100}, 6600);
  rod.masses.setConstant(steel.points, 1e-3);
  rod.walls = {{.point = {0, -0.01, 0}, .normal = {0, 1, 0}, .stiffness = 100}};
  rod.solids = {
      {.body = obstacle::Body::sphere({0.3, -0.05, 0}, 0.045), .stiffness = 100, .samples = 2}};
  struct Steps {
    Stepper stepper;
    double time_step;
  };
  for (const Steps& steps : {Steps{Stepper::verlet, 1e-5}, Steps{Stepper::implicit, 1e-2},
                             Steps{Stepper::implicit, INFINITY}}) {
    StepOptions options;
    options.policy = policy(steps.stepper);
    options.time_step = steps.time_step;
    options.damping_rate = 1;
    Simulation simulation(rod, steel.straight(), options);
    Eigen::Matrix3Xd targets = rod.grips[0].targets;
    const long before = allocations;
    bool good = true;
    for (int i = 0; i < 50; ++i) {
      targets.row(1).array() += 1e-4;
      simulation.move_grip(0, targets, {0, 0, 0});
      good = good && simulation.step().status == StepStatus::good;
    }
    EXPECT_EQ(allocations, before) << "stepper " << static_cast<int>(steps.stepper);
    EXPECT_TRUE(good);
  }
}

TEST(Simulation, StepsAndTurnsOfATwistedRodDoNotAllocate) {
  test::TwistedRod twisted;
  twisted.turn = 1;
  const Rod rod = twisted.rod();
  const Grip& last = rod.grips[1];
  Simulation simulation(rod, twisted.arch(), StepOptions{});
  Eigen::Matrix3Xd forces(3, twisted.points);
  Eigen::Matrix3Xd points = twisted.arch();
  std::vector<GripReaction> reactions(2);
  const long before = allocations;
  bool good = true;
  for (int i = 0; i < 100; ++i) good = good && simulation.step().status == StepStatus::good;
  simulation.move_grip(1, last.targets, last.reference, Eigen::Vector3d::UnitZ());
  simulation.move_grip(1, last.targets, last.reference);
  good = good && simulation.step().status == StepStatus::good;
  simulation.copy_points(points);
  grip_reactions(simulation.rod(), points, forces, reactions);
  EXPECT_EQ(allocations, before);
  EXPECT_TRUE(good);
}

TEST(Simulation, AHapticFrameDoesNotAllocate) {
  const test::SteelRod steel;
  Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  rod.walls = {{.point = {0, -0.01, 0}, .normal = {0, 1, 0}, .stiffness = 100}};
  for (const GripHold hold : {GripHold::rigid, GripHold::spring}) {
    rod.grips[0].hold = hold;
    rod.grips[0].stiffness = 1000;
    Simulation simulation(rod, steel.straight(), StepOptions{});
    Eigen::Matrix3Xd targets = rod.grips[0].targets;
    Eigen::Matrix3Xd points(3, steel.points);
    Eigen::Matrix3Xd forces(3, steel.points);
    std::vector<GripReaction> reactions(1);
    Wall wall = rod.walls[0];
    const long before = allocations;
    targets.row(1).array() += 1e-4;
    wall.point.y() += 1e-4;
    simulation.move_grip(0, targets, targets.col(0));
    simulation.move_wall(0, wall);
    const bool good = simulation.step().status == StepStatus::good;
    simulation.copy_points(points);
    grip_reactions(simulation.rod(), points, forces, reactions);
    EXPECT_EQ(allocations, before);
    EXPECT_TRUE(good);
    EXPECT_GT(reactions[0].force.norm(), 0);
  }
}

}  // namespace
}  // namespace dlo::force_model

#endif
