#include "dlo/force_model/step_size.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "polygons.hpp"
#include "rods.hpp"

namespace dlo::force_model {
namespace {

using test::random_polygon;
using test::SteelRod;

/// Minus the derivative of the forces on the free points, by central differences.
Eigen::MatrixXd stiffness_matrix(const Rod& rod, Eigen::Matrix3Xd points) {
  const Eigen::Index n = points.size();
  Eigen::MatrixXd matrix(n, n);
  Eigen::Matrix3Xd above(3, points.cols());
  Eigen::Matrix3Xd below(3, points.cols());
  const double h = 1e-7;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double x = points.data()[k];
    points.data()[k] = x + h;
    total_forces(rod, points, above);
    points.data()[k] = x - h;
    total_forces(rod, points, below);
    points.data()[k] = x;
    matrix.col(k) = -(above - below).reshaped() / (2 * h);
  }
  return matrix.bottomRightCorner(n - 6, n - 6);  // without the two held points
}

double spectral_radius(const Eigen::MatrixXd& matrix) {
  return matrix.eigenvalues().cwiseAbs().maxCoeff();
}

TEST(ModeBounds, FastestModeIsNeverUnderestimatedOnRandomShapes) {
  const SteelRod steel;
  for (const Bending bending :
       {Bending{BendingLaw::hooke, steel.EI}, Bending{BendingLaw::paper, 3574.96}}) {
    for (unsigned seed = 0; seed < 30; ++seed) {
      for (const double c_c : {10.0, 660.0}) {
        const Rod rod = steel.rod(bending, c_c);
        const Eigen::Matrix3Xd points = random_polygon(seed, 15, steel.segment(), 0.05);
        const double radius = spectral_radius(stiffness_matrix(rod, points));
        EXPECT_GE(mode_bounds(rod, points).fastest, radius) << "seed " << seed;
        EXPECT_LE(mode_bounds(rod, points).fastest, 12 * radius) << "seed " << seed;
      }
    }
  }
}

TEST(ModeBounds, OfAStraightHookeanRodAreCloseToItsSpectrum) {
  SteelRod steel;
  steel.points = 32;
  const Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  const ModeBounds bounds = mode_bounds(rod, steel.straight());
  const Eigen::VectorXd spectrum =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness_matrix(rod, steel.straight()))
          .eigenvalues();
  EXPECT_NEAR(bounds.slowest / spectrum[0], 1, 0.15);  // N = 32 and half a segment inside the grip
  EXPECT_LT(spectrum[spectrum.size() - 1], bounds.fastest);
}

TEST(StepFactor, IsTheStabilityLimitOfTheLinearStep) {
  EXPECT_DOUBLE_EQ(largest_step_factor(100, 0), 0.02);
  EXPECT_DOUBLE_EQ(largest_step_factor(100, 0.5), 0.03);
  EXPECT_THROW((void)largest_step_factor(0, 0), std::invalid_argument);
  EXPECT_THROW((void)largest_step_factor(1, 1), std::invalid_argument);
}

TEST(HeavyBall, ShrinksBothExtremeModesAtTheSameRate) {
  const HeavyBall ball = heavy_ball({.fastest = 100, .slowest = 1});
  EXPECT_DOUBLE_EQ(ball.c_F, 4.0 / (11 * 11));
  EXPECT_DOUBLE_EQ(ball.c_h, 81.0 / 121);
  for (const double mode : {100.0, 1.0}) {
    // x_{t+1} = (1 + c_h - c_F mode) x_t - c_h x_{t-1}
    const double trace = 1 + ball.c_h - ball.c_F * mode;
    const double discriminant = trace * trace / 4 - ball.c_h;
    EXPECT_NEAR(discriminant, 0, 1e-12);  // a double root, sqrt(c_h)
  }
}

}  // namespace
}  // namespace dlo::force_model
