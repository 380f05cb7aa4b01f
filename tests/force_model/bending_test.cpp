#include "dlo/force_model/bending.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "polygons.hpp"

namespace dlo::force_model {
namespace {

using std::numbers::pi;

Eigen::Matrix3Xd forces_of(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& rest,
                           const Bending& bending) {
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, points.cols());
  add_bending_forces(points, rest, bending, forces);
  return forces;
}

/// Returns the points of two segments of length L in the plane with the angle alpha between them.
Eigen::Matrix3Xd one_joint(double L, double alpha) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 3);
  points.col(0) << -L, 0, 0;
  points.col(2) << L * std::cos(alpha), L * std::sin(alpha), 0;
  return points;
}

class BendingOfBothLaws : public testing::TestWithParam<BendingLaw> {
 protected:
  [[nodiscard]] static Bending bending() { return {GetParam(), 2.5}; }
};

TEST_P(BendingOfBothLaws, IsZeroForAStraightRod) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 5);
  points.row(1).setLinSpaced(0, 4);
  const Eigen::Matrix3Xd forces = forces_of(points, Eigen::VectorXd::Ones(4), bending());
  EXPECT_EQ(forces.cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(bending_energy(points, Eigen::VectorXd::Ones(4), bending()), 0);
}

TEST_P(BendingOfBothLaws, OpensTheJoint) {
  const Eigen::Matrix3Xd forces = forces_of(one_joint(1, 0.5), Eigen::Vector2d::Ones(), bending());
  EXPECT_LT(forces(1, 2), 0);  // the last point is above the line of the first segment
  EXPECT_LT(forces(1, 0), 0);
  EXPECT_GT(forces(1, 1), 0);
}

// This holds for the paper's law too: the part of F perpendicular to a segment has the same torque
// about the joint as F, which points along the chord.
TEST_P(BendingOfBothLaws, ForcesAndTorquesSumToZeroForAnySegments) {
  for (const double spread : {0.0, 0.1, 0.9}) {
    for (unsigned seed = 0; seed < 100; ++seed) {
      const Eigen::Matrix3Xd points = random_polygon(seed, 15, 0.1, spread);
      const Eigen::Matrix3Xd forces =
          forces_of(points, Eigen::VectorXd::Constant(15, 0.1), bending());
      const double scale = forces.cwiseAbs().sum();
      ASSERT_LT(forces.rowwise().sum().norm(), 1e-14 * scale) << seed;
      ASSERT_LT(net_torque(points, forces).norm(), 1e-14 * scale) << seed;
    }
  }
}

TEST_P(BendingOfBothLaws, MomentIsWhatTheLawSays) {
  for (const double alpha : {0.01, 0.2, 1.0, 2.0, 2.9}) {
    const double L = 0.3;
    const Eigen::Matrix3Xd points = one_joint(L, alpha);
    const Eigen::Vector3d force = forces_of(points, Eigen::Vector2d::Constant(L), bending()).col(2);
    const Eigen::Vector3d arm = points.col(2);
    EXPECT_NEAR(-arm.cross(force).z(), joint_moment(bending(), L, alpha),
                1e-14 * joint_moment(bending(), L, alpha) + 1e-16)
        << "alpha = " << alpha;
  }
}

TEST_P(BendingOfBothLaws, MomentIsTheDerivativeOfThePotentialAndStiffnessOfTheMoment) {
  const double h = 1e-5;
  for (const double alpha : {0.05, 0.5, 1.5, 2.5, 3.1}) {
    const auto U = [&](double a) { return joint_potential(bending(), 0.3, a); };
    const auto M = [&](double a) { return joint_moment(bending(), 0.3, a); };
    const double scale = std::abs(M(alpha)) + joint_stiffness(bending(), 0.3, alpha);
    EXPECT_NEAR((U(alpha + h) - U(alpha - h)) / (2 * h), M(alpha), 1e-7 * scale) << alpha;
    EXPECT_NEAR((M(alpha + h) - M(alpha - h)) / (2 * h), joint_stiffness(bending(), 0.3, alpha),
                1e-6 * scale)
        << alpha;
  }
}

TEST_P(BendingOfBothLaws, FullFoldIsFiniteBalancedAndOpens) {
  const Eigen::Matrix3Xd points = one_joint(1, pi);
  Eigen::Matrix3Xd exact_fold = points;
  exact_fold.col(2) = exact_fold.col(0);
  const Eigen::Matrix3Xd forces = forces_of(exact_fold, Eigen::Vector2d::Ones(), bending());
  ASSERT_TRUE(forces.allFinite());
  EXPECT_GT(forces.col(2).norm(), bending().stiffness);
  EXPECT_LT(forces.rowwise().sum().norm(), 1e-12);
  EXPECT_LT(net_torque(exact_fold, forces).norm(), 1e-12);
  EXPECT_TRUE(std::isfinite(joint_potential(bending(), 1, pi)));
}

TEST_P(BendingOfBothLaws, ZeroLengthSegmentExertsNothing) {
  Eigen::Matrix3Xd points = one_joint(1, 0.5);
  points.col(2) = points.col(1);
  EXPECT_EQ(forces_of(points, Eigen::Vector2d::Ones(), bending()).cwiseAbs().maxCoeff(), 0);
  points.setZero();
  points.col(2).setConstant(-1);
  EXPECT_EQ(bending_energy(points, Eigen::Vector2d::Ones(), bending()), 0);
}

INSTANTIATE_TEST_SUITE_P(Laws, BendingOfBothLaws,
                         testing::Values(BendingLaw::paper, BendingLaw::hooke),
                         [](const auto& instance) {
                           return instance.param == BendingLaw::paper ? "paper" : "hooke";
                         });

/// Returns the moment of one joint of the paper's law between segments of lengths a and b.
double paper_moment(double a, double b, double alpha) {
  Eigen::Matrix3Xd points = one_joint(1, alpha);
  points.col(0) *= a;
  points.col(2) *= b;
  const Eigen::Matrix3Xd forces =
      forces_of(points, Eigen::Vector2d(a, b), {BendingLaw::paper, 2.5});
  const Eigen::Vector3d arm = points.col(2);
  return arm.cross(Eigen::Vector3d(forces.col(2))).norm();
}

TEST(PaperBending, IsWeakerBetweenUnequalSegmentsThanItsMeanLengthSays) {
  const double alpha = 0.01;
  for (const double b : {1.1, 2.0, 3.0}) {
    const double share =
        paper_moment(1, b, alpha) / joint_moment({BendingLaw::paper, 2.5}, (1 + b) / 2, alpha);
    // c_b (1 - cos alpha) sin alpha a b / |a u + b v|, and a = b = (a + b) / 2 in the other
    EXPECT_NEAR(share, 4 * b / ((1 + b) * (1 + b)), alpha * alpha) << b;
    RecordProperty("moment_share_at_ratio_" + std::to_string(static_cast<int>(10 * b)),
                   std::to_string(share));
  }
}

/// Returns the median over random shapes of |F + dU/dP| / |F|.
double paper_share_without_potential(double length_spread) {
  const Bending bending{BendingLaw::paper, 2.5};
  std::vector<double> shares;
  for (unsigned seed = 0; seed < 25; ++seed) {
    const Eigen::Matrix3Xd points = random_polygon(seed, 15, 0.1, length_spread);
    const Eigen::VectorXd lengths =
        (points.rightCols(15) - points.leftCols(15)).colwise().norm().transpose();
    const Eigen::Matrix3Xd forces = forces_of(points, lengths, bending);
    const Eigen::Matrix3Xd gradient = difference_forces(
        [&](const Eigen::Matrix3Xd& p) { return bending_energy(p, lengths, bending); }, points,
        1e-6);
    shares.push_back((forces - gradient).norm() / forces.norm());
  }
  std::nth_element(shares.begin(), shares.begin() + 12, shares.end());
  return shares[12];
}

TEST(PaperBending, HasAPotentialBetweenEqualSegmentsOnly) {
  EXPECT_LT(paper_share_without_potential(0), 1e-8);
  const double tenth = paper_share_without_potential(0.1);
  const double half = paper_share_without_potential(0.5);
  RecordProperty("spread_0.1", std::to_string(tenth));
  RecordProperty("spread_0.5", std::to_string(half));
  EXPECT_GT(half, 10 * tenth);  // second order in the difference
}

TEST(HookeBending, IsTheGradientOfItsEnergy) {
  const Eigen::Matrix3Xd points = random_polygon(8, 7, 0.1, 0.5);
  const Eigen::VectorXd rest = Eigen::VectorXd::LinSpaced(7, 0.08, 0.12);
  const Bending bending{BendingLaw::hooke, 2.5};
  const Eigen::Matrix3Xd forces = forces_of(points, rest, bending);
  const Eigen::Matrix3Xd expected = difference_forces(
      [&](const Eigen::Matrix3Xd& p) { return bending_energy(p, rest, bending); }, points, 1e-6);
  // Central differences at h = 1e-6 of L = 0.1: truncation (h/L)^2 = 1e-10, rounding eps L/h =
  // 2e-11
  EXPECT_LT((forces - expected).cwiseAbs().maxCoeff(), 1e-8 * forces.cwiseAbs().maxCoeff());
}

TEST(HookeBending, MatchesAHookeanRodToSecondOrder) {
  const Bending bending{BendingLaw::hooke, 2.5};
  // 2 tan(alpha/2) = alpha + alpha^3/12 + ...
  for (const double alpha : {0.1, 0.05}) {
    const double linear = bending.stiffness / 0.3 * alpha;
    EXPECT_NEAR(joint_moment(bending, 0.3, alpha) / linear - 1, alpha * alpha / 12,
                alpha * alpha * alpha * alpha / 100);
  }
}

TEST(PaperBending, ForceIsFormula3AndItsPartAcrossTheSegments) {
  // alpha = 90 deg, L = 1: u = x, v = y, e = (1, 1)/sqrt 2, F = c_b e, across v: c_b x / sqrt 2
  const Eigen::Matrix3Xd forces =
      forces_of(one_joint(1, pi / 2), Eigen::Vector2d::Ones(), {BendingLaw::paper, 2.5});
  const double part = 2.5 / std::numbers::sqrt2;
  EXPECT_LT((forces.col(2) - Eigen::Vector3d(part, 0, 0)).norm(), 1e-15);
  EXPECT_LT((forces.col(0) - Eigen::Vector3d(0, -part, 0)).norm(), 1e-15);
  EXPECT_LT((forces.col(1) - Eigen::Vector3d(-part, part, 0)).norm(), 1e-15);
}

TEST(PaperBending, PotentialIsTheClosedForm) {
  const double alpha = 1.3;
  const double c = std::cos(alpha / 2);
  EXPECT_NEAR(joint_potential({BendingLaw::paper, 2.5}, 0.3, alpha),
              2.5 * 0.3 * (8.0 / 3 - 4 * c + 4.0 / 3 * c * c * c), 1e-15);
}

// P(alpha) = -4 k log cos(alpha/2) and M(alpha) = 2 k tan(alpha/2), with k = 2.5 and the angle 0.
TEST(Bending, EnergyOfANaturalTurnNextToAZeroLengthSegmentIsThatOfAStraightJoint) {
  Bending bent{BendingLaw::hooke, 2.5};
  bent.natural_turns = Eigen::VectorXd::Constant(1, 0.5);
  for (const double direction : {-1.0, 1.0}) {
    Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 3);
    points.col(2) << direction, direction, 0;
    EXPECT_NEAR(bending_energy(points, Eigen::Vector2d::Ones(), bent),
                10 * std::log(std::cos(0.25)) + 2.5 * std::tan(0.25), 1e-14);
  }
}

TEST(Bending, RefusesBadNumbers) {
  EXPECT_THROW((void)joint_moment({BendingLaw::hooke, -1}, 1, 0.1), std::invalid_argument);
  EXPECT_THROW((void)joint_moment({BendingLaw::hooke, 1}, 0, 0.1), std::invalid_argument);
  EXPECT_THROW((void)joint_moment({BendingLaw::hooke, 1}, 1, 4), std::invalid_argument);
  EXPECT_THROW((void)joint_moment({BendingLaw::hooke, 1}, 1, NAN), std::invalid_argument);
  Eigen::Matrix3Xd points = one_joint(1, 0.5);
  points(0, 0) = NAN;
  EXPECT_THROW(forces_of(points, Eigen::Vector2d::Ones(), {}), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::force_model
