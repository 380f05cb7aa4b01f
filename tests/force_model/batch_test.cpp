// Tests that each rod of a batch moves as in a Simulation of its own.

#include "dlo/force_model/batch.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "dlo/force_model/simulation.hpp"
#include "random_rods.hpp"
#include "rods.hpp"

namespace dlo::force_model {
namespace {

std::vector<BatchRod> random_rods(std::size_t count, Eigen::Index points, const Variant& variant) {
  std::vector<BatchRod> rods;
  for (unsigned seed = 0; seed < count; ++seed) {
    BatchRod one;
    one.rod = test::random_rod(seed, points, variant);
    one.rod.c_c *= 1 + 0.1 * seed;
    if (seed % 3 == 1) one.rod.walls.resize(one.rod.walls.size() / 2);
    one.points = test::random_points(seed, points, std::get<Space>(variant));
    one.options = test::options_for(std::get<Stepper>(variant), one.rod);
    one.options.c_h -= 0.05 * seed / static_cast<double>(count);
    rods.push_back(one);
  }
  return rods;
}

void expect_agreement(const std::vector<BatchRod>& rods, int steps) {
  Batch batch(rods);
  std::vector<Simulation> simulations;
  simulations.reserve(rods.size());
  for (const BatchRod& one : rods) simulations.emplace_back(one.rod, one.points, one.options);
  for (int i = 0; i < steps; ++i) {
    batch.step(1);
    for (std::size_t rod = 0; rod < rods.size(); ++rod) {
      const bool good = simulations[rod].step().status == StepStatus::good;
      ASSERT_EQ(batch.diverged(rod), !good) << "rod " << rod << ", step " << i;
      const double difference =
          (batch.points(rod) - simulations[rod].points()).cwiseAbs().maxCoeff();
      ASSERT_LT(difference, 1e-12 * (i + 1) * test::length) << "rod " << rod << ", step " << i;
      ASSERT_EQ(batch.steps(rod), simulations[rod].steps());
    }
  }
}

class BatchOfVariants : public testing::TestWithParam<Variant> {};

TEST_P(BatchOfVariants, AgreesWithASimulationOfEachRod) {
  for (const InstructionSet set : available_instruction_sets()) {
    for (const std::size_t count : {1U, 8U, 13U}) {
      for (const Eigen::Index points : {2, 3, 16, 33}) {
        SCOPED_TRACE(std::string(to_string(set)) + ", " + std::to_string(points) + " points");
        std::vector<BatchRod> rods = random_rods(count, points, GetParam());
        for (BatchRod& one : rods) one.options.instruction_set = set;
        expect_agreement(rods, 40);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Variants, BatchOfVariants,
                         testing::Combine(testing::Values(BendingLaw::paper, BendingLaw::hooke),
                                          testing::Values(Stepper::basic, Stepper::limited,
                                                          Stepper::dynamic, Stepper::automatic),
                                          testing::Values(GripHold::rigid, GripHold::spring),
                                          testing::Values(Walls::none, Walls::two),
                                          testing::Values(Space::plane, Space::full)));

TEST(Batch, LeavesFoldedRodsToThePlainForces) {
  const Variant variant{BendingLaw::hooke, Stepper::dynamic, GripHold::rigid, Walls::none,
                        Space::full};
  std::vector<BatchRod> rods = random_rods(8, 12, variant);
  rods[2].points.col(6) = rods[2].points.col(4);
  rods[5].points.col(7) = rods[5].points.col(8);
  expect_agreement(rods, 3);
}

TEST(Batch, StopsDivergedRodsAndStepsTheOthers) {
  const Variant variant{BendingLaw::hooke, Stepper::basic, GripHold::rigid, Walls::none,
                        Space::full};
  std::vector<BatchRod> rods = random_rods(8, 12, variant);
  rods[3].options.c_F = 1e6;
  Batch batch(rods);
  batch.step(500);
  Batch expected(random_rods(8, 12, variant));
  expected.step(500);
  for (std::size_t rod = 0; rod < 8; ++rod) {
    EXPECT_EQ(batch.diverged(rod), rod == 3);
    EXPECT_TRUE(batch.points(rod).allFinite());
    if (rod != 3) {
      EXPECT_EQ(batch.points(rod), expected.points(rod));
      EXPECT_EQ(batch.steps(rod), 500);
    }
  }
  EXPECT_LT(batch.steps(3), 500);
  EXPECT_EQ(batch.relax({.max_steps = 20})[3].status, RelaxStatus::diverged);
}

TEST(Batch, RelaxesEachRodToItsOwnRest) {
  std::vector<BatchRod> rods;
  for (int i = 0; i < 11; ++i) {
    test::SteelRod steel;
    steel.angle = 0.3 * i;
    steel.EI /= 1 + i;
    rods.push_back({steel.rod({BendingLaw::hooke, steel.EI}, 660), steel.straight(), {}});
  }
  Batch batch(rods);
  const std::vector<RelaxResult> results = batch.relax();
  ASSERT_EQ(results.size(), rods.size());
  for (std::size_t rod = 0; rod < rods.size(); ++rod) {
    Simulation simulation(rods[rod].rod, rods[rod].points, rods[rod].options);
    const RelaxResult expected = simulation.relax();
    ASSERT_EQ(results[rod].status, RelaxStatus::at_rest);
    EXPECT_NEAR(static_cast<double>(results[rod].steps), static_cast<double>(expected.steps), 16);
    const double distance = (batch.points(rod) - simulation.points()).norm() / 4;  // RMS of 16
    EXPECT_LT(distance, results[rod].remaining_error + expected.remaining_error);
  }
}

TEST(Batch, MovesTheGripperOfOneRod) {
  const test::SteelRod steel;
  const BatchRod one{steel.rod({BendingLaw::hooke, steel.EI}, 660), steel.straight(), {}};
  Batch batch({one, one});
  const Eigen::Matrix3Xd targets =
      grip_targets({0, 0, 0.1}, {1, 0, 0}, steel.segment(), steel.segment() / 2);
  batch.move_grip(1, 0, targets, {0, 0, 0.1});
  EXPECT_EQ(batch.points(0), one.points);
  EXPECT_EQ(batch.points(1).leftCols(2), targets);
  EXPECT_THROW(batch.move_grip(2, 0, targets, {0, 0, 0}), std::invalid_argument);
}

TEST(Batch, RefusesRodsThatCannotShareAKernel) {
  const test::SteelRod steel;
  const BatchRod one{steel.rod({BendingLaw::hooke, steel.EI}, 660), steel.straight(), {}};
  test::SteelRod longer;
  longer.points = 17;
  const BatchRod other_size{longer.rod({BendingLaw::hooke, steel.EI}, 660), longer.straight(), {}};
  BatchRod other_law = one;
  other_law.rod.bending.law = BendingLaw::paper;
  BatchRod other_policy = one;
  other_policy.options.policy.damping = true;
  EXPECT_THROW(Batch({}), std::invalid_argument);
  for (const BatchRod& other : {other_size, other_law, other_policy}) {
    EXPECT_THROW(Batch({one, other}), std::invalid_argument);
  }
}

}  // namespace
}  // namespace dlo::force_model
