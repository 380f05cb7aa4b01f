#include "dlo/force_model/contraction.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "polygons.hpp"

namespace dlo::force_model {
namespace {

constexpr double c_c = 3.0;

Eigen::Matrix3Xd forces_of(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& rest) {
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, points.cols());
  add_contraction_forces(points, rest, c_c, forces);
  return forces;
}

TEST(Contraction, PullsTogetherByTheRelativeExtension) {
  Eigen::Matrix3Xd points(3, 2);
  points << 0, 1.2, 0, 0, 0, 0;
  const Eigen::Matrix3Xd forces = forces_of(points, Eigen::VectorXd::Constant(1, 1.0));
  EXPECT_NEAR(forces(0, 0), 0.2 * c_c, 1e-15);  // (1): c_c (1.2 - 1) / 1 towards the neighbour
  EXPECT_NEAR(forces(0, 1), -0.2 * c_c, 1e-15);
}

TEST(Contraction, ForcesAndTorquesSumToZeroForAnySegments) {
  const Eigen::Matrix3Xd points = random_polygon(2, 12, 0.1, 0.8);
  const Eigen::Matrix3Xd forces = forces_of(points, Eigen::VectorXd::LinSpaced(12, 0.05, 0.2));
  EXPECT_LT(forces.rowwise().sum().norm(), 1e-14);
  EXPECT_LT(net_torque(points, forces).norm(), 1e-14);
}

TEST(Contraction, IsTheGradientOfItsEnergy) {
  const Eigen::Matrix3Xd points = random_polygon(3, 7, 0.1, 0.5);
  const Eigen::VectorXd rest = Eigen::VectorXd::LinSpaced(7, 0.08, 0.12);
  const Eigen::Matrix3Xd expected = difference_forces(
      [&](const Eigen::Matrix3Xd& p) { return contraction_energy(p, rest, c_c); }, points, 1e-6);
  // Truncation h^2 E''' ~ 1e-12 * c_c / L^2 = 3e-10, rounding eps E / h ~ 1e-10
  EXPECT_LT((forces_of(points, rest) - expected).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(Contraction, SegmentOfZeroLengthIsPushedApartAlongItsNeighbours) {
  Eigen::Matrix3Xd points(3, 4);
  points << 0, 0, 0, 0, 0, 1, 1, 2, 0, 0, 0, 0;
  const Eigen::Matrix3Xd forces = forces_of(points, Eigen::VectorXd::Ones(3));
  EXPECT_TRUE(forces.allFinite());
  EXPECT_NEAR(forces(1, 1), -c_c, 1e-15);
  EXPECT_NEAR(forces(1, 2), c_c, 1e-15);
  // If the neighbours are at the same point too, the direction is arbitrary.
  EXPECT_TRUE(forces_of(Eigen::Matrix3Xd::Zero(3, 6), Eigen::VectorXd::Ones(5)).allFinite());
}

TEST(Contraction, RefusesWhatIsNotARod) {
  Eigen::Matrix3Xd points = random_polygon(4, 3, 0.1, 0);
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, 4);
  const Eigen::VectorXd rest = Eigen::VectorXd::Constant(3, 0.1);
  EXPECT_THROW(add_contraction_forces(points, rest, -1, forces), std::invalid_argument);
  EXPECT_THROW(add_contraction_forces(points, rest, NAN, forces), std::invalid_argument);
  EXPECT_THROW(add_contraction_forces(points, Eigen::VectorXd::Zero(3), 1, forces),
               std::invalid_argument);
  EXPECT_THROW(add_contraction_forces(points.leftCols(3), rest, 1, forces), std::invalid_argument);
  points(1, 2) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(add_contraction_forces(points, rest, 1, forces), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::force_model
