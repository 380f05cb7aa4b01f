#include "dlo/energy_model/chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "../differences.hpp"
#include "dlo/energy_model/exact.hpp"
#include "joint_laws.hpp"
#include "solved.hpp"

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
  problem.stiffness = law == JointLaw::paper ? 20 : 1;
  return problem;
}

class ChainOfEveryLaw : public testing::TestWithParam<JointLaw> {};

TEST_P(ChainOfEveryLaw, GradientIsTheDifferenceOfTheEnergy) {
  const ChainProblem problem = heavy_chain(GetParam(), 9, 5);
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::VectorXd angles(9);
  for (double& angle : angles) angle = uniform(engine);
  angles[0] = 0;
  Eigen::VectorXd gradient(9);
  Eigen::VectorXd unused(9);
  (void)chain_energy(problem, angles, gradient);
  const Eigen::VectorXd expected = difference_gradient(
      [&](const Eigen::VectorXd& at) { return chain_energy(problem, at, unused); }, angles, 1e-6);
  for (Eigen::Index i = 1; i < 9; ++i) {
    EXPECT_NEAR(gradient[i], expected[i], 1e-8 * (1 + std::abs(expected[i]))) << i;
  }
  EXPECT_EQ(gradient[0], 0);
}

/// Returns the moment of a joint of stiffness 1 between segments of length 1 that is bent by alpha.
double unit_moment(JointLaw law, double alpha) {
  const double s = std::sin(alpha / 2);
  const double t = std::tan(alpha / 2);
  switch (law) {
    case JointLaw::paper:
      return 2 * s * s * s;
    case JointLaw::hooke:
      return 2 * t;
    case JointLaw::linear:
      return alpha;
    case JointLaw::binormal:
      break;
  }
  return 2 * t * (1 + t * t);
}

// Two segments: the first one is held along x, and a force at the end is rotated from x by phi. The
// shape with the joint angle alpha is a minimum in the plane. Rotating the second segment about x
// by a small angle p does not change the joint angle and changes the energy by F L sin(alpha)
// sin(phi) p^2 / 2. The shape is therefore a minimum in space for phi < pi, and a saddle beyond.
TEST_P(ChainOfEveryLaw, IsASaddleWhereItLeavesThePlane) {
  constexpr double alpha = 1.5;
  constexpr double pi = std::numbers::pi;
  for (const double phi : {pi - 0.1, pi - 1e-3, pi + 1e-3, pi + 0.1}) {
    ChainProblem problem;
    problem.segment_lengths.setOnes(2);
    problem.law = GetParam();
    problem.stiffness = 1;
    problem.node_forces.setZero(2, 3);
    problem.node_forces.col(2) = unit_moment(GetParam(), alpha) / std::sin(phi - alpha) *
                                 Eigen::Vector2d(std::cos(phi), std::sin(phi));
    const ChainResult result = solve_chain(problem, {.start_angles = Eigen::Vector2d(0, alpha)});
    EXPECT_NEAR(result.angles[1], alpha, 1e-9);
    EXPECT_EQ(result.status, phi < pi ? SolveStatus::converged : SolveStatus::saddle) << phi;
  }
}

TEST_P(ChainOfEveryLaw, EveryJointCarriesTheMomentOfWhatHangsBeyond) {
  const ChainProblem problem = heavy_chain(GetParam(), 15, 3);
  const ChainResult result = test::require_usable(solve_chain(problem));
  for (Eigen::Index i = 1; i < 15; ++i) {
    double moment = 0;
    for (Eigen::Index j = i + 1; j <= 15; ++j) {
      moment += (result.points(0, j) - result.points(0, i)) * problem.node_forces(1, j);
    }
    const double alpha = result.angles[i] - result.angles[i - 1];
    const double L = problem.segment_lengths[0];
    const double unit = problem.stiffness * (GetParam() == JointLaw::paper ? L : 1 / L);
    EXPECT_NEAR(unit * unit_moment(GetParam(), alpha), moment, 1e-11) << "joint " << i;
  }
}

TEST(Chain, HookeanLawsApproachTheRodInSecondOrder) {
  constexpr double gamma = 20;
  Problem rod;
  rod.length = 1;
  rod.bending_stiffness = 1;
  rod.weight_per_length = {0, -gamma, 0};
  rod.grips = {{0, {0, 0, 0}, Eigen::Vector3d(1, 0, 0), std::nullopt}};
  const Eigen::Vector3d tip = solve_exact(rod).sample(std::vector{1.0}).points.col(0);
  for (const JointLaw law : {JointLaw::hooke, JointLaw::linear, JointLaw::binormal}) {
    double before = 0;
    for (const int segments : {20, 40, 80, 160}) {
      const ChainResult chain =
          test::require_usable(solve_chain(heavy_chain(law, segments, gamma)));
      const double error = (chain.points.rightCols<1>() - tip.head<2>()).norm();
      if (before > 0) EXPECT_NEAR(std::log2(before / error), 2, 0.15) << segments;
      before = error;
    }
  }
}

TEST_P(ChainOfEveryLaw, ConvergesForManyPointsAndSoftRods) {
  for (const double gamma : {0.01, 1.0, 100.0, 1000.0}) {
    for (const int segments : {4, 31, 300}) {
      const ChainResult result = solve_chain(heavy_chain(GetParam(), segments, gamma));
      EXPECT_TRUE(succeeded(result.status)) << gamma << ", " << segments << ": " << result.message;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, ChainOfEveryLaw, testing::ValuesIn(test::joint_laws),
                         [](const auto& instance) { return test::name_of(instance.param); });

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

TEST(Chain, StoppedEarlyIsAFailure) {
  EXPECT_FALSE(
      succeeded(solve_chain(heavy_chain(JointLaw::paper, 20, 5), {.max_evaluations = 1}).status));
}

TEST(Chain, RefusesBadProblems) {
  const auto refused = [](const auto& invalidate) {
    ChainProblem problem = heavy_chain(JointLaw::hooke, 5, 1);
    invalidate(problem);
    EXPECT_THROW((void)solve_chain(problem), std::invalid_argument);
  };
  refused([](ChainProblem& p) { p.stiffness = 0; });
  refused([](ChainProblem& p) { p.segment_lengths[2] = -1; });
  refused([](ChainProblem& p) { p.node_forces(0, 3) = NAN; });
  refused([](ChainProblem& p) { p.node_forces.resize(2, 3); });
}

}  // namespace
}  // namespace dlo::energy_model
