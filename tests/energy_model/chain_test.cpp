#include "dlo/energy_model/chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace dlo::energy_model {
namespace {

ChainProblem heavy_chain(JointLaw law, int segments, double gamma) {
  ChainProblem problem;
  const double L = 1.0 / (segments - 0.5);
  problem.segment_lengths = Eigen::VectorXd::Constant(segments, L);
  problem.start = {-L / 2, 0};
  problem.node_forces.setZero(2, segments + 1);
  for (int i = 1; i <= segments; ++i) {
    problem.node_forces(1, i) = -gamma * L * (i == segments ? 0.5 : 1);
  }
  problem.law = law;
  problem.stiffness = law == JointLaw::hooke ? 1 : 20;
  return problem;
}

class ChainOfBothLaws : public testing::TestWithParam<JointLaw> {};

TEST_P(ChainOfBothLaws, GradientIsTheDifferenceOfTheEnergy) {
  const ChainProblem problem = heavy_chain(GetParam(), 9, 5);
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::VectorXd angles(9);
  for (double& angle : angles) angle = uniform(engine);
  angles[0] = 0;
  Eigen::VectorXd gradient(9);
  Eigen::VectorXd unused(9);
  (void)chain_energy(problem, angles, gradient);
  const double h = 1e-6;
  for (Eigen::Index i = 1; i < 9; ++i) {
    Eigen::VectorXd above = angles;
    Eigen::VectorXd below = angles;
    above[i] += h;
    below[i] -= h;
    const double difference =
        (chain_energy(problem, above, unused) - chain_energy(problem, below, unused)) / (2 * h);
    EXPECT_NEAR(gradient[i], difference, 1e-8 * (1 + std::abs(difference))) << i;
  }
  EXPECT_EQ(gradient[0], 0);
}

TEST_P(ChainOfBothLaws, EveryJointCarriesTheMomentOfWhatHangsBeyond) {
  const ChainProblem problem = heavy_chain(GetParam(), 15, 3);
  const ChainResult result = solve_chain(problem);
  ASSERT_TRUE(succeeded(result.status)) << result.message;
  for (Eigen::Index i = 1; i < 15; ++i) {
    double moment = 0;
    for (Eigen::Index j = i + 1; j <= 15; ++j) {
      moment += (result.points(0, j) - result.points(0, i)) * problem.node_forces(1, j);
    }
    const double alpha = result.angles[i] - result.angles[i - 1];
    const double L = problem.segment_lengths[0];
    const double law = GetParam() == JointLaw::hooke
                           ? 2 * problem.stiffness / L * std::tan(alpha / 2)
                           : 2 * problem.stiffness * L * std::pow(std::sin(alpha / 2), 3);
    EXPECT_NEAR(law, moment, 1e-11) << "joint " << i;
  }
}

TEST_P(ChainOfBothLaws, ConvergesForManyPointsAndSoftRods) {
  for (const double gamma : {0.01, 1.0, 100.0, 1000.0}) {
    for (const int segments : {4, 31, 300}) {
      const ChainResult result = solve_chain(heavy_chain(GetParam(), segments, gamma));
      EXPECT_TRUE(succeeded(result.status)) << gamma << ", " << segments << ": " << result.message;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, ChainOfBothLaws, testing::Values(JointLaw::paper, JointLaw::hooke),
                         [](const auto& instance) {
                           return instance.param == JointLaw::paper ? "paper" : "hooke";
                         });

TEST(Chain, StopsAtItsTimeLimit) {
  ChainProblem problem;
  problem.segment_lengths = Eigen::VectorXd::Constant(50, 0.02);
  problem.node_forces.setZero(2, 51);
  problem.node_forces.row(1).setConstant(-0.2);
  problem.stiffness = 1;
  EXPECT_EQ(solve_chain(problem, {.time_limit = 1e-9}).status, SolveStatus::time_limit);
  EXPECT_EQ(solve_chain(problem).status, SolveStatus::converged);
  EXPECT_THROW((void)solve_chain(problem, {.time_limit = 0}), std::invalid_argument);
}

TEST(Chain, EvaluationsOfAHookeanChainDoNotGrowWithItsPoints) {
  EXPECT_LE(solve_chain(heavy_chain(JointLaw::hooke, 1000, 2)).evaluations,
            solve_chain(heavy_chain(JointLaw::hooke, 15, 2)).evaluations + 5);
}

TEST(Chain, WithoutForcesIsStraight) {
  const ChainResult result = solve_chain(heavy_chain(JointLaw::hooke, 10, 0));
  EXPECT_TRUE(succeeded(result.status));
  EXPECT_LT(result.points.row(1).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(Chain, StoppedEarlyIsAFailure) {
  ChainOptions options;
  options.max_evaluations = 1;
  EXPECT_FALSE(succeeded(solve_chain(heavy_chain(JointLaw::paper, 20, 5), options).status));
}

TEST(Chain, RefusesBadProblems) {
  ChainProblem problem = heavy_chain(JointLaw::hooke, 5, 1);
  problem.stiffness = 0;
  EXPECT_THROW((void)solve_chain(problem), std::invalid_argument);
  problem = heavy_chain(JointLaw::hooke, 5, 1);
  problem.segment_lengths[2] = -1;
  EXPECT_THROW((void)solve_chain(problem), std::invalid_argument);
  problem = heavy_chain(JointLaw::hooke, 5, 1);
  problem.node_forces(0, 3) = NAN;
  EXPECT_THROW((void)solve_chain(problem), std::invalid_argument);
  problem = heavy_chain(JointLaw::hooke, 5, 1);
  problem.node_forces.resize(2, 3);
  EXPECT_THROW((void)solve_chain(problem), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::energy_model
