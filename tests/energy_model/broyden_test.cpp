#include "newton/broyden.hpp"

#include <gtest/gtest.h>

namespace dlo::energy_model {
namespace {

/// Steps of x that solve A x = b as if A were one, until they are at rounding.
int steps_to_solution(const Eigen::MatrixXd& a, bool updated) {
  const Eigen::VectorXd b = Eigen::VectorXd::Ones(a.rows());
  Eigen::VectorXd x = Eigen::VectorXd::Zero(a.rows());
  BroydenSteps broyden;
  Eigen::VectorXd step = b - a * x;
  int count = 0;
  while (step.norm() > 1e-12 && count < 100) {
    x += step;
    const Eigen::VectorXd last = step;
    step = b - a * x;
    if (updated) broyden.update(last, step);
    ++count;
  }
  EXPECT_LT((a * x - b).norm(), 1e-11);
  return count;
}

/// Broyden's method ends after twice as many steps as there are linear equations (Gay, 1979); steps
/// that each shrink to a third take 1e-12 = (1/3)^25.
TEST(Broyden, EndsAtTheSolutionOfLinearEquations) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(3, 3);
  a(0, 0) = 2.0 / 3;
  a(0, 1) = 0.2;
  a(1, 2) = -0.3;
  a(2, 0) = 0.1;
  EXPECT_LE(steps_to_solution(a, true), 6);
  EXPECT_GT(steps_to_solution(a, false), 20);
}

TEST(Broyden, BeginsAnewWithAnotherFactor) {
  BroydenSteps broyden;
  const Eigen::VectorXd last = Eigen::Vector2d(1, 0);
  Eigen::VectorXd once = Eigen::Vector2d(0.2, 0.1);
  broyden.update(last, once);
  EXPECT_LT((once - Eigen::Vector2d(0.25, 0.125)).norm(), 1e-15);
  broyden.clear();
  Eigen::VectorXd again = Eigen::Vector2d(0.2, 0.1);
  broyden.update(last, again);
  EXPECT_EQ(again, once);
}

/// A step that hardly shrinks would be made much longer.
TEST(Broyden, LeavesStepsThatHardlyShrink) {
  BroydenSteps broyden;
  Eigen::VectorXd next = Eigen::Vector2d(0.9, 0);
  broyden.update(Eigen::Vector2d(1, 0), next);
  EXPECT_EQ(next, Eigen::VectorXd(Eigen::Vector2d(0.9, 0)));
}

}  // namespace
}  // namespace dlo::energy_model
