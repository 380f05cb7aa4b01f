// Tests of the step kernel against steps written with total_forces and Eigen, on every instruction
// set of this machine.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "dlo/force_model/simulation.hpp"
#include "plain_simulation.hpp"
#include "random_rods.hpp"

namespace dlo::force_model {
namespace {

/// Steps both and compares positions [l], scalings and movements step by step.
void expect_agreement(const Rod& rod, const Eigen::Matrix3Xd& start, const StepOptions& options,
                      int steps) {
  test::PlainSimulation plain(rod, start, options);
  Simulation simulation(rod, start, options);
  for (int i = 0; i < steps; ++i) {
    const StepResult expected = plain.step();
    const StepResult result = simulation.step();
    ASSERT_EQ(result.status, expected.status);
    ASSERT_EQ(result.limited, expected.limited);
    // Rounding grows from step to step like the shape's own sensitivity; the steps here are small.
    const double allowed = 1e-12 * (i + 1);
    ASSERT_NEAR(result.c_m, expected.c_m, allowed * expected.c_m);
    ASSERT_NEAR(result.movement, expected.movement, allowed * length);
    ASSERT_LT((simulation.points() - plain.points()).cwiseAbs().maxCoeff(), allowed * length)
        << "step " << i;
  }
}

class StepKernel : public testing::TestWithParam<Variant> {};

TEST_P(StepKernel, AgreesWithThePlainStepOnEveryInstructionSet) {
  const auto& [law, stepper, hold, walls, space] = GetParam();
  std::vector<Eigen::Index> sizes = {64, 200};
  for (Eigen::Index points = 2; points <= 40; ++points) sizes.push_back(points);
  for (const InstructionSet set : available_instruction_sets()) {
    for (const Eigen::Index points : sizes) {
      SCOPED_TRACE(std::string(to_string(set)) + ", " + std::to_string(points) + " points");
      const auto seed = static_cast<unsigned>(points);
      const Rod rod = random_rod(seed, points, GetParam());
      StepOptions options = options_for(stepper, rod);
      options.instruction_set = set;
      expect_agreement(rod, random_points(seed, points, space), options, 20);
    }
  }
}

TEST_P(StepKernel, LeavesFoldsAndPointsThatCoincideToThePlainForces) {
  const auto& [law, stepper, hold, walls, space] = GetParam();
  constexpr Eigen::Index points = 12;
  const Rod rod = random_rod(1, points, GetParam());
  const StepOptions options = options_for(stepper, rod);
  const double L = length / (points - 1);
  Eigen::Matrix3Xd folded = random_points(2, points, space);
  folded.col(6) = folded.col(4);  // two segments that coincide
  Eigen::Matrix3Xd sharp = folded;
  sharp(1, 6) += 0.05 * L;  // beyond hooke_fold_angle, but with a direction
  Eigen::Matrix3Xd coincident = folded;
  coincident.col(7) = coincident.col(8);
  Eigen::Matrix3Xd all_in_one = Eigen::Matrix3Xd::Zero(3, points);
  for (const Eigen::Matrix3Xd& start : {folded, sharp, coincident, all_in_one}) {
    for (const InstructionSet set : available_instruction_sets()) {
      StepOptions with_set = options;
      with_set.instruction_set = set;
      expect_agreement(rod, start, with_set, 3);
    }
  }
}

class UnlimitedStepKernel : public testing::TestWithParam<Variant> {};

TEST_P(UnlimitedStepKernel, DivergesInTheSameStepAndLeavesThePoints) {
  const auto& [law, stepper, hold, walls, space] = GetParam();
  constexpr Eigen::Index points = 12;
  const Rod rod = random_rod(1, points, GetParam());
  StepOptions options = options_for(stepper, rod);
  options.c_F = 1e6;
  for (const InstructionSet set : available_instruction_sets()) {
    options.instruction_set = set;
    test::PlainSimulation plain(rod, random_points(1, points, space), options);
    Simulation simulation(rod, random_points(1, points, space), options);
    Eigen::Matrix3Xd last;
    StepResult result;
    long steps = 0;
    do {
      last = simulation.points();
      result = simulation.step();
      ASSERT_EQ(result.status, plain.step().status) << "step " << steps;
      ASSERT_LT(++steps, 10000);
    } while (result.status == StepStatus::good);
    EXPECT_EQ(simulation.points(), last);
    EXPECT_EQ(simulation.steps(), steps - 1);
  }
}

std::string name(const testing::TestParamInfo<Variant>& instance) {
  const auto& [law, stepper, hold, walls, space] = instance.param;
  constexpr const char* steppers[] = {"basic", "limited", "relative", "dynamic", "automatic"};
  return std::string(law == BendingLaw::paper ? "paper_" : "hooke_") +
         steppers[static_cast<std::size_t>(stepper)] +
         (hold == GripHold::rigid ? "_rigid" : "_spring") + (walls == Walls::none ? "" : "_walls") +
         (space == Space::plane ? "_plane" : "_space");
}

/// Returns the variants with these steppers, a generator of Google Test.
template <typename Steppers>
auto variants(const Steppers& steppers) {
  return testing::Combine(testing::Values(BendingLaw::paper, BendingLaw::hooke), steppers,
                          testing::Values(GripHold::rigid, GripHold::spring),
                          testing::Values(Walls::none, Walls::two),
                          testing::Values(Space::plane, Space::full));
}

INSTANTIATE_TEST_SUITE_P(Variants, StepKernel,
                         variants(testing::Values(Stepper::basic, Stepper::limited,
                                                  Stepper::relative, Stepper::dynamic,
                                                  Stepper::automatic)),
                         name);

INSTANTIATE_TEST_SUITE_P(Variants, UnlimitedStepKernel, variants(testing::Values(Stepper::basic)),
                         name);

TEST(Kernel, BoundsTheModesLikeModeBounds) {
  // The automatic step size is chosen from the bound at the beginning of the first step, in both
  // implementations.
  for (const BendingLaw law : {BendingLaw::paper, BendingLaw::hooke}) {
    for (unsigned seed = 0; seed < 50; ++seed) {
      const Variant variant{law, Stepper::automatic, GripHold::spring, Walls::two, Space::full};
      Rod rod = random_rod(seed, 20, variant);
      rod.bending.stiffness *= 10;
      rod.c_c = 0.1;
      for (const InstructionSet set : available_instruction_sets()) {
        StepOptions options;
        options.instruction_set = set;
        Simulation simulation(rod, random_points(seed, 20, Space::full), options);
        const ModeBounds expected = mode_bounds(rod, simulation.points());
        ASSERT_EQ(simulation.step().status, StepStatus::good);
        ModeBounds modes = expected;
        modes.slowest =
            std::clamp(expected.slowest, smallest_mode_ratio * modes.fastest, modes.fastest);
        EXPECT_NEAR(simulation.options().c_F / heavy_ball(modes).c_F, 1, 1e-12) << seed;
      }
    }
  }
}

TEST(Kernel, LeavesThePlaneWhenATargetDoes) {
  const Variant variant{BendingLaw::hooke, Stepper::automatic, GripHold::rigid, Walls::none,
                        Space::plane};
  const Rod rod = random_rod(3, 16, variant);
  Simulation simulation(rod, random_points(3, 16, Space::plane), {});
  ASSERT_EQ(simulation.step().status, StepStatus::good);
  EXPECT_EQ(simulation.points().row(2).cwiseAbs().maxCoeff(), 0);
  Eigen::Matrix3Xd targets = rod.grips.front().targets;
  targets.row(2).setConstant(0.01);
  simulation.move_grip(0, targets, {0, 0, 0.01});
  ASSERT_EQ(simulation.step().status, StepStatus::good);
  EXPECT_GT(std::abs(simulation.points()(2, 2)), 0);
}

}  // namespace
}  // namespace dlo::force_model
