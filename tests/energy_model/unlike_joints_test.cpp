// Tests of chains and polygons whose joints have different stiffnesses or rest angles.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dlo/energy_model/chain.hpp"
#include "dlo/energy_model/polygon.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

constexpr Eigen::Index n = 15;

Eigen::VectorXd varying_stiffnesses(double stiffness) {
  Eigen::VectorXd result(n - 1);
  for (Eigen::Index i = 0; i < n - 1; ++i) {
    result[i] = stiffness * (2 + std::sin(1.7 * static_cast<double>(i)));
  }
  return result;
}

Eigen::VectorXd turns(double size) {
  Eigen::VectorXd result(n - 1);
  for (Eigen::Index i = 0; i < n - 1; ++i) {
    result[i] = size * (0.5 + std::sin(2.3 * static_cast<double>(i)));
  }
  return result;
}

ChainProblem bent_chain() {
  ChainProblem problem;
  problem.segment_lengths = Eigen::VectorXd::LinSpaced(n, 0.05, 0.09);
  problem.first_angle = 0.4;
  problem.node_forces = Eigen::Matrix2Xd::Zero(2, n + 1);
  problem.node_forces.row(1).setConstant(-0.1);
  problem.node_forces(0, n) = 0.2;
  problem.stiffness = 0.2;
  problem.stiffnesses = varying_stiffnesses(0.2);
  problem.natural_turns = turns(0.5);
  return problem;
}

/// Returns the chain with elastic segments; the points of the first segment are held.
PolygonProblem bent_polygon() {
  const ChainProblem chain = bent_chain();
  PolygonProblem problem;
  problem.rest_lengths = chain.segment_lengths;
  problem.stretch_stiffness = 1e5;
  problem.node_forces = Eigen::Matrix3Xd::Zero(3, n + 1);
  problem.node_forces.topRows<2>() = chain.node_forces;
  problem.stiffness = chain.stiffness;
  problem.stiffnesses = chain.stiffnesses;
  problem.natural_turns = chain.natural_turns;
  const double L = chain.segment_lengths[0];
  problem.held = {{0, Eigen::Vector3d::Zero()},
                  {1, {L * std::cos(chain.first_angle), L * std::sin(chain.first_angle), 0}}};
  return problem;
}

Eigen::Matrix3Xd straight_start(const PolygonProblem& problem) {
  Eigen::Matrix3Xd start = Eigen::Matrix3Xd::Zero(3, n + 1);
  const Eigen::Vector3d along = problem.held[1].position.normalized();
  for (Eigen::Index i = 0; i < n; ++i) {
    start.col(i + 1) = start.col(i) + problem.rest_lengths[i] * along;
  }
  return start;
}

TEST(UnlikeJoints, ThePolygonsGradientIsItsEnergysDerivative) {
  const PolygonProblem problem = bent_polygon();
  Eigen::Matrix3Xd points = straight_start(problem);
  for (Eigen::Index i = 0; i <= n; ++i) {
    points(0, i) += 0.01 * std::sin(3.0 * static_cast<double>(i));
    points(1, i) += 0.02 * std::cos(2.0 * static_cast<double>(i));
  }
  Eigen::Matrix3Xd gradient(3, n + 1);
  (void)polygon_energy(problem, points, gradient);
  Eigen::Matrix3Xd unused(3, n + 1);
  constexpr double h = 1e-7;
  for (Eigen::Index i = 0; i <= n; ++i) {
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      Eigen::Matrix3Xd ahead = points;
      Eigen::Matrix3Xd back = points;
      ahead(axis, i) += h;
      back(axis, i) -= h;
      const double slope =
          (polygon_energy(problem, ahead, unused) - polygon_energy(problem, back, unused)) /
          (2 * h);
      EXPECT_NEAR(gradient(axis, i), slope, 1e-7 * gradient.cwiseAbs().maxCoeff()) << i;
    }
    EXPECT_EQ(gradient(2, i), 0);
  }
}

TEST(UnlikeJoints, AFreeChainTakesItsTurnsAndHasNoEnergy) {
  ChainProblem problem = bent_chain();
  problem.node_forces.setZero();
  const ChainResult result = test::converged(solve_chain(problem));
  const Eigen::VectorXd turned = result.angles.tail(n - 1) - result.angles.head(n - 1);
  EXPECT_LT((turned - problem.natural_turns).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_NEAR(result.bending_energy, 0, 1e-15);
}

TEST(UnlikeJoints, TheStiffPolygonComesToRestWhereTheRigidChainDoes) {
  const ChainResult chain = test::converged(solve_chain(bent_chain()));
  double before = 0;
  for (const double stretch : {1e5, 1e6}) {
    PolygonProblem problem = bent_polygon();
    problem.stretch_stiffness = stretch;
    const PolygonResult polygon =
        test::require_usable(solve_polygon(problem, straight_start(problem)));
    EXPECT_TRUE(polygon.points.row(2).isZero(0));
    const double apart = (polygon.points.topRows<2>() - chain.points).cwiseAbs().maxCoeff();
    // The remaining difference is stretch, about 2 N divided by the stretch stiffness.
    EXPECT_LT(apart, 20 / stretch);
    if (before > 0) {
      EXPECT_NEAR(before / apart, 10, 0.5);
    }
    before = apart;
  }
}

TEST(UnlikeJoints, AreRefusedOutOfRange) {
  ChainProblem chain = bent_chain();
  chain.natural_turns[4] = -3;
  EXPECT_THROW((void)solve_chain(chain), std::invalid_argument);
  chain = bent_chain();
  chain.law = JointLaw::paper;
  EXPECT_THROW((void)solve_chain(chain), std::invalid_argument);
  chain = bent_chain();
  chain.stiffnesses.conservativeResize(n - 2);
  EXPECT_THROW((void)solve_chain(chain), std::invalid_argument);
  PolygonProblem polygon = bent_polygon();
  const Eigen::Matrix3Xd start = straight_start(polygon);
  polygon.node_forces(2, 3) = 1e-6;
  EXPECT_THROW((void)solve_polygon(polygon, start), std::invalid_argument);
  polygon = bent_polygon();
  polygon.stiffnesses[2] = 0;
  EXPECT_THROW((void)solve_polygon(polygon, start), std::invalid_argument);
  Eigen::Matrix3Xd lifted = start;
  lifted(2, 9) = 1e-12;
  EXPECT_THROW((void)solve_polygon(bent_polygon(), lifted), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::energy_model
