// Tests of the gradient flow (shooting/gradient_flow.hpp) by which the exact solver leaves a
// twisted shape that has become unstable.

#include <gtest/gtest.h>

#include <optional>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "equilibrium_balance.hpp"
#include "rolled_clamps.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// Returns a heavy rod of unit length and stiffness, clamped at both ends, the second one rolled.
Problem heavy_rolled_clamps(const Eigen::Vector3d& end, const Eigen::Vector3d& direction,
                            double weight, double c, double roll) {
  Problem problem = test::rolled_clamps(end, direction, c, roll);
  problem.weight_per_length = {0, -weight, 0};
  return problem;
}

/// Returns the largest distance between the points of a shape, with horizontal clamps 0.8 apart,
/// and those after a half rotation about the vertical line halfway between the clamps. This
/// rotation exchanges the ends.
double asymmetry(const Equilibrium& shape) {
  const Eigen::Matrix3Xd points = shape.sample(equal_arc_lengths(1, 21)).points;
  Eigen::Matrix3Xd turned = points.rowwise().reverse();
  turned.row(0) = 0.8 - turned.row(0).array();
  turned.row(2) *= -1;
  return (points - turned).colwise().norm().maxCoeff();
}

// The continuation follows the symmetric shape, which is an equilibrium at every roll. At a roll of
// 12 it is a saddle.
TEST(GradientFlow, LeavesTheSymmetryThatHasBecomeUnstable) {
  const auto at = [](double roll) {
    return heavy_rolled_clamps({0.8, 0, 0}, Eigen::Vector3d::UnitX(), 50, 2, roll);
  };
  const Equilibrium before = test::converged(solve_exact(at(11)));
  EXPECT_LT(asymmetry(before), 1e-9);
  const Equilibrium after = test::converged(solve_exact(at(12)));
  EXPECT_GT(asymmetry(after), 1e-2);
  EXPECT_GT(after.smallest_eigenvalue, 0);
  EXPECT_LT(test::balance_of(at(12), after, 0.01).worst(), 1e-10);
}

TEST(GradientFlow, GivesUpTwistBeyondAFold) {
  const auto at = [](double roll) {
    return heavy_rolled_clamps({0.6, 0.2, 0.1}, {0.8, 0.3, -0.5}, 20, 0.7, roll);
  };
  const Equilibrium before = solve_exact(at(5));
  const Equilibrium after = solve_exact(at(5.25));
  ASSERT_EQ(before.status, SolveStatus::converged) << before.message;
  ASSERT_EQ(after.status, SolveStatus::converged) << after.message;
  EXPECT_GT(after.smallest_eigenvalue, 0);
  EXPECT_LT(test::balance_of(at(5.25), after, 0.01).worst(), 1e-10);
  // The roll increases and the twist decreases: the difference becomes writhe.
  EXPECT_LT(after.twists.at(0).angle, before.twists.at(0).angle - 1);
  // The energy grows by less than the previous torque times the change of roll.
  EXPECT_LT(after.energy.total(), before.energy.total() + 0.25 * before.twists[0].torque);
  const Equilibrium energy = test::converged(solve_energy(at(5.25), {.start = &after}));
  EXPECT_NEAR(energy.energy.total(), after.energy.total(), 1e-8);
}

}  // namespace
}  // namespace dlo::energy_model
