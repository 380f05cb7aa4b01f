#include "dlo/energy_model/polygon.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "../differences.hpp"
#include "joint_laws.hpp"
#include "polygon/polygon_energy.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

constexpr double stiff = 4e6;  // 16 (l/d)^2 of a rod 500 diameters long, over EI/l^2

/// Returns a rod of unit length and rigidity (20 for the paper's law) under its weight along -y,
/// both ends clamped `span` apart.
PolygonProblem between_clamps(JointLaw law, Eigen::Index points, double span, double gamma) {
  PolygonProblem problem;
  const double L = 1.0 / static_cast<double>(points - 2);
  problem.rest_lengths = Eigen::VectorXd::Constant(points - 1, L);
  problem.stretch_stiffness = stiff;
  problem.node_forces.setZero(3, points);
  problem.node_forces.row(1).segment(1, points - 2).setConstant(-gamma * L);
  problem.law = law;
  problem.stiffness = law == JointLaw::paper ? 20 : 1;
  problem.held = {{0, {-L / 2, 0, 0}},
                  {1, {L / 2, 0, 0}},
                  {points - 2, {span - L / 2, 0, 0}},
                  {points - 1, {span + L / 2, 0, 0}}};
  return problem;
}

/// Returns half a sine with the slack of the polygon, rotated about the line of the grips.
/// @param turned  angle [rad]
Eigen::Matrix3Xd arch(const PolygonProblem& problem, double span, double turned) {
  const Eigen::Index n = problem.node_forces.cols();
  const double height = 2 / std::numbers::pi * std::sqrt(span * (1 - span));
  Eigen::Matrix3Xd points(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(n - 1);
    const double y = -height * std::sin(std::numbers::pi * t);
    points.col(i) << span * t, y * std::cos(turned), y * std::sin(turned);
  }
  return points;
}

class PolygonOfEveryLaw : public testing::TestWithParam<JointLaw> {};

TEST_P(PolygonOfEveryLaw, GradientIsTheDifferenceOfTheEnergy) {
  PolygonProblem problem = between_clamps(GetParam(), 9, 0.8, 5);
  problem.stretch_stiffness = 50;
  problem.rest_lengths[3] *= 1.3;
  problem.obstacles = {{obstacle::Body::half_space({0, -0.1, 0}, Eigen::Vector3d(0.6, 0.8, 0)), 30},
                       {obstacle::Body::sphere({0.3, 0.1, 0.05}, 0.3), 20, 3}};
  Eigen::Matrix3Xd points = arch(problem, 0.8, 0.3);
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-0.05, 0.05);
  for (double& x : points.reshaped()) x += uniform(engine);
  // One joint is bent beyond the angle at which the moment of the law hooke stops growing.
  points.col(6) = points.col(4) + Eigen::Vector3d(0, 0.004, 0.002);
  Eigen::Matrix3Xd gradient(3, 9);
  Eigen::Matrix3Xd unused(3, 9);
  (void)polygon_energy(problem, points, gradient);
  const Eigen::Matrix3Xd expected = difference_gradient(
      [&](const Eigen::Matrix3Xd& p) { return polygon_energy(problem, p, unused); }, points, 1e-7);
  EXPECT_LT((gradient - expected).cwiseAbs().maxCoeff(), 1e-6 * gradient.cwiseAbs().maxCoeff());
}

TEST_P(PolygonOfEveryLaw, RestsInFewStepsAndBalancesItsForces) {
  for (const double gamma : {0.0, 1.0, 100.0, 1000.0}) {
    for (const Eigen::Index points : {8, 33, 200}) {
      const PolygonProblem problem = between_clamps(GetParam(), points, 0.8, gamma);
      const PolygonResult result = solve_polygon(problem, arch(problem, 0.8, 0));
      ASSERT_TRUE(succeeded(result.status)) << gamma << ", " << points << ": " << result.message;
      // With the cubic law and without weight the Hessian tends to zero at the equilibrium, so that
      // Newton's method converges slowly.
      const bool fading = GetParam() == JointLaw::paper && gamma == 0;
      EXPECT_LT(result.evaluations, fading ? 1000 : 200) << gamma << ", " << points;
      const Eigen::Vector3d total =
          result.grip_forces.rowwise().sum() + problem.node_forces.rowwise().sum();
      EXPECT_LT(total.norm(), 1e-6 * (1 + gamma)) << gamma << ", " << points;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, PolygonOfEveryLaw, testing::ValuesIn(test::joint_laws),
                         [](const auto& instance) { return test::name_of(instance.param); });

TEST(Polygon, IsTheRigidChainWhenItHasOneClamp) {
  for (const JointLaw law : test::joint_laws) {
    for (const double gamma : {0.1, 2.0, 30.0}) {
      ChainProblem chain;
      const Eigen::Index n = 20;
      const double L = 1 / (static_cast<double>(n) - 0.5);
      chain.segment_lengths = Eigen::VectorXd::Constant(n, L);
      chain.segment_lengths.tail(8) *= 0.7;  // unequal segments have the same potential in both
      chain.node_forces.setZero(2, n + 1);
      chain.node_forces.row(1).tail(n).setConstant(-gamma * L);
      chain.law = law;
      chain.stiffness = law == JointLaw::paper ? 20 : 1;
      const ChainResult rigid = test::require_usable(solve_chain(chain));
      PolygonProblem problem;
      problem.rest_lengths = chain.segment_lengths;
      problem.stretch_stiffness = stiff * (1 + gamma);
      problem.node_forces.setZero(3, n + 1);
      problem.node_forces.topRows(2) = chain.node_forces;
      problem.law = law;
      problem.stiffness = chain.stiffness;
      problem.held = {{0, {0, 0, 0}}, {1, {L, 0, 0}}};
      Eigen::Matrix3Xd start = Eigen::Matrix3Xd::Zero(3, n + 1);
      for (Eigen::Index i = 0; i < n; ++i) start(0, i + 1) = start(0, i) + problem.rest_lengths[i];
      const PolygonResult result = test::require_usable(solve_polygon(problem, start));
      // The strain is at most w l / c_c = 1 / stiff.
      EXPECT_LT((result.points.topRows(2) - rigid.points).colwise().norm().maxCoeff(), 2 / stiff)
          << gamma;
      EXPECT_LT(result.points.row(2).cwiseAbs().maxCoeff(), 1e-9);
    }
  }
}

TEST(Polygon, LeavesASaddle) {
  // Straight between two grips that press it together: Euler's column.
  PolygonProblem problem = between_clamps(JointLaw::hooke, 42, 0.95, 0);
  Eigen::Matrix3Xd start(3, 42);
  for (Eigen::Index i = 0; i < 42; ++i) {
    start.col(i) = Eigen::Vector3d(0.95 * static_cast<double>(i) / 41, 0, 0);
  }
  const PolygonResult buckled = test::require_usable(solve_polygon(problem, start));
  // A column clamped at both ends buckles at P = 4 pi^2. Beyond buckling the load is P (1 + e / 2),
  // where e is the relative shortening. The polygon is softer by O(L^2).
  const double thrust = buckled.grip_forces.leftCols<2>().rowwise().sum().x();
  const double euler = 4 * std::numbers::pi * std::numbers::pi;
  EXPECT_GT(thrust, euler);
  EXPECT_LT(thrust, euler * (1 + 0.05));
  const double sideways = buckled.points.bottomRows(2).colwise().norm().maxCoeff();
  EXPECT_NEAR(sideways, 2 / std::numbers::pi * std::sqrt(0.05), 0.01);
}

Eigen::MatrixXd hessian_of(const PolygonProblem& problem, const Eigen::Matrix3Xd& points,
                           HessianTerms which) {
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(points.size(), points.size());
  polygon_hessian(problem, points, which,
                  [&](Eigen::Index row, Eigen::Index column, const Eigen::Matrix3d& block) {
                    hessian.block<3, 3>(3 * row, 3 * column) += block;
                  });
  return hessian;
}

double smallest_eigenvalue(const Eigen::MatrixXd& hessian) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(hessian, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .minCoeff();
}

// For crumpled polygons within a ball and a floor the complete Hessian is indefinite, and the
// stiffening part has no negative eigenvalue. For a straight polygon under tension, clear of
// obstacles, both are equal.
TEST_P(PolygonOfEveryLaw, StiffeningSecondDerivativesAreNeverNegative) {
  PolygonProblem problem = between_clamps(GetParam(), 12, 0.8, 5);
  problem.stretch_stiffness = 500;
  problem.obstacles = {
      {obstacle::Body::half_space({0, -0.1, 0}, Eigen::Vector3d(0.6, 0.8, 0)), 300},
      {obstacle::Body::sphere({0.3, 0.1, 0.05}, 0.3), 200, 3}};
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(-0.1, 0.1);
  for (int draw = 0; draw < 20; ++draw) {
    Eigen::Matrix3Xd points = arch(problem, 0.8, 0.3);
    for (double& x : points.reshaped()) x += uniform(engine);
    const Eigen::MatrixXd all = hessian_of(problem, points, HessianTerms::all);
    const Eigen::MatrixXd positive_terms =
        hessian_of(problem, points, HessianTerms::positive_terms);
    const double largest = positive_terms.cwiseAbs().maxCoeff();
    EXPECT_LT(smallest_eigenvalue(all), 0);
    EXPECT_GT(smallest_eigenvalue(positive_terms), -1e-13 * largest);
    EXPECT_LT((positive_terms - positive_terms.transpose()).cwiseAbs().maxCoeff(), 1e-13 * largest);
  }
  Eigen::Matrix3Xd straight = Eigen::Matrix3Xd::Zero(3, 12);
  straight.row(0).setLinSpaced(12, 0, 1.5);
  straight.row(2).setConstant(9);
  problem.obstacles.resize(1);
  problem.obstacles[0].body = obstacle::Body::half_space({0, -9, 0}, Eigen::Vector3d::UnitY());
  const Eigen::MatrixXd all = hessian_of(problem, straight, HessianTerms::all);
  const Eigen::MatrixXd positive_terms =
      hessian_of(problem, straight, HessianTerms::positive_terms);
  EXPECT_LT((all - positive_terms).cwiseAbs().maxCoeff(), 1e-12 * all.cwiseAbs().maxCoeff());
}

// A rope that is compressed to half of its length above a floor: with damping as the only remedy
// for negative curvature it took 511 evaluations. Fewer than 150 are allowed.
TEST(Polygon, ASoftRopeThatIsCompressedComesToRestInTensOfSteps) {
  PolygonProblem problem = between_clamps(JointLaw::hooke, 80, 0.5, 2000);
  problem.obstacles = {{obstacle::Body::half_space({0, -0.1, 0}, Eigen::Vector3d::UnitY()), stiff}};
  Eigen::Matrix3Xd start = arch(problem, 0.5, 0.3);
  start.bottomRows(2) *= 0.05;
  const PolygonResult rope =
      test::require_usable(solve_polygon(problem, start, {.project_hessian = true}));
  EXPECT_LT(rope.evaluations, 150);
}

TEST(Polygon, ObstaclePushesBackWithItsStiffness) {
  PolygonProblem problem = between_clamps(JointLaw::hooke, 33, 0.9, 20);
  const PolygonResult free = test::require_usable(solve_polygon(problem, arch(problem, 0.9, 0)));
  const double sag = free.points.row(1).minCoeff();
  problem.obstacles = {
      {obstacle::Body::half_space({0, sag / 2, 0}, Eigen::Vector3d::UnitY()), 1e5}};
  const PolygonResult held = test::require_usable(solve_polygon(problem, arch(problem, 0.9, 0)));
  const Eigen::ArrayXd depth = (sag / 2 - held.points.row(1).array()).max(0.0);
  EXPECT_GT(depth.maxCoeff(), 0);
  EXPECT_LT(depth.maxCoeff(), 1e-3);
  const double total =
      held.grip_forces.row(1).sum() + problem.node_forces.row(1).sum() + 1e5 * depth.sum();
  EXPECT_NEAR(total, 0, 1e-6);
}

// On a floor whose segments have stiffnesses in proportion to their lengths a heavy chain sinks
// equally everywhere: w L / (k L).
TEST(Polygon, SegmentsOfOwnStiffnessSinkEqually) {
  constexpr double weight = 3;
  constexpr double floor = 60;
  PolygonProblem problem = between_clamps(JointLaw::hooke, 7, 1, 0);
  const Eigen::Index n = problem.rest_lengths.size();
  problem.rest_lengths.segment(1, n - 2) << 0.1, 0.25, 0.05, 0.2;
  const double depth = weight / floor;
  Eigen::Matrix3Xd start = Eigen::Matrix3Xd::Zero(3, n + 1);
  start.row(1).setConstant(-depth);
  problem.node_forces.setZero();
  for (Eigen::Index i = 0; i < n; ++i) {
    start(0, i + 1) = start(0, i) + problem.rest_lengths[i];
    problem.node_forces.block(1, i, 1, 2).array() -= weight * problem.rest_lengths[i] / 2;
  }
  problem.held = {
      {0, start.col(0)}, {1, start.col(1)}, {n - 1, start.col(n - 1)}, {n, start.col(n)}};
  problem.obstacles = {
      {.body = obstacle::Body::half_space(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitY()),
       .stiffnesses = floor * problem.rest_lengths}};
  Eigen::Matrix3Xd bent = start;
  bent.row(1).segment(2, n - 3).array() += 0.02;
  const PolygonResult rest = test::require_usable(solve_polygon(problem, bent));
  EXPECT_LT((rest.points - start).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(Polygon, StoppedEarlyIsAFailure) {
  const PolygonProblem problem = between_clamps(JointLaw::hooke, 20, 0.8, 5);
  EXPECT_EQ(solve_polygon(problem, arch(problem, 0.8, 0), {.max_evaluations = 2}).status,
            SolveStatus::evaluation_limit);
}

TEST(Polygon, StopsAtItsTimeLimit) {
  const PolygonProblem problem = between_clamps(JointLaw::hooke, 20, 0.8, 5);
  const PolygonResult late = solve_polygon(problem, arch(problem, 0.8, 0), {.time_limit = 1e-9});
  EXPECT_EQ(late.status, SolveStatus::time_limit);
  EXPECT_THROW((void)solve_polygon(problem, arch(problem, 0.8, 0), {.time_limit = 0}),
               std::invalid_argument);
}

// A short step in a stiff segment is a large force, so results are judged by forces too.
TEST(Polygon, AToleranceOfLengthsLeavesNoForce) {
  for (const double gamma : {17.0, 19.0, 21.0, 23.0}) {
    PolygonProblem problem = between_clamps(JointLaw::hooke, 17, 0.8, gamma);
    problem.stretch_stiffness = 4e8;
    const PolygonResult result =
        test::require_usable(solve_polygon(problem, arch(problem, 0.8, 0), {.tolerance = 5e-8}));
    const double acting = result.grip_forces.colwise().norm().maxCoeff();
    EXPECT_LT(result.residual, 1e-6 * acting) << gamma;
  }
}

TEST(Polygon, ReturnsTheResidualOfThePointsThatItReturns) {
  for (const int most : {2, 5, 10, 20000}) {
    const PolygonProblem problem = between_clamps(JointLaw::hooke, 20, 0.8, 5);
    const PolygonResult result =
        solve_polygon(problem, arch(problem, 0.8, 0.2), {.max_evaluations = most});
    Eigen::Matrix3Xd gradient(3, 20);
    EXPECT_EQ(result.energy, polygon_energy(problem, result.points, gradient));
    const double left = gradient.middleCols(2, 16).colwise().norm().maxCoeff();
    EXPECT_DOUBLE_EQ(result.residual, left);
    // Forces that act are about 5 (the weight) and more; rounding of a position moves a stiff
    // segment's force by 1e-16 x 4e6 x 18.
    if (succeeded(result.status)) {
      EXPECT_LT(left, 1e-6);
    }
  }
}

TEST(Polygon, RefusesBadProblems) {
  const PolygonProblem good = between_clamps(JointLaw::hooke, 10, 0.8, 5);
  const Eigen::Matrix3Xd start = arch(good, 0.8, 0);
  const auto refused = [&](const auto& invalidate) {
    PolygonProblem problem = good;
    invalidate(problem);
    EXPECT_THROW((void)solve_polygon(problem, start), std::invalid_argument);
  };
  refused([](PolygonProblem& p) { p.stiffness = 0; });
  refused([](PolygonProblem& p) { p.stretch_stiffness = -1; });
  refused([](PolygonProblem& p) { p.rest_lengths[2] = 0; });
  refused([](PolygonProblem& p) { p.node_forces(0, 3) = NAN; });
  refused([](PolygonProblem& p) { p.node_forces.resize(3, 4); });
  refused([](PolygonProblem& p) { p.held.clear(); });
  refused([](PolygonProblem& p) { p.held[0].point = 10; });
  refused([](PolygonProblem& p) { p.held[1].point = 0; });
  refused([](PolygonProblem& p) { p.obstacles = {{{}, 1, 0}}; });
  Eigen::Matrix3Xd coincident = start;
  coincident.col(4) = coincident.col(5);
  EXPECT_THROW((void)solve_polygon(good, coincident), std::invalid_argument);
  EXPECT_THROW((void)solve_polygon(good, start, {.tolerance = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::energy_model
