#include "dlo/force_model/step_size.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "../differences.hpp"
#include "polygons.hpp"
#include "rods.hpp"

namespace dlo::force_model {
namespace {

/// Minus the derivative of the forces by all points, by central differences.
Eigen::MatrixXd full_stiffness(const Rod& rod, const Eigen::Matrix3Xd& points) {
  Eigen::Matrix3Xd forces(3, points.cols());
  const auto forces_at = [&](const Eigen::Matrix3Xd& p) {
    total_forces(rod, p, forces);
    return Eigen::VectorXd(forces.reshaped());
  };
  return -difference_matrix(forces_at, points, 1e-7);
}

/// Returns the stiffness of the points behind a clamp that holds the first two.
Eigen::MatrixXd stiffness_matrix(const Rod& rod, const Eigen::Matrix3Xd& points) {
  const Eigen::Index n = points.size() - 6;
  return full_stiffness(rod, points).bottomRightCorner(n, n);
}

/// Returns the largest eigenvalue of the stiffness of the points that no rigid grip holds. Negative
/// eigenvalues, such as those of a folded rod, do not limit the step: their modes grow with any
/// c_F.
double measured_fastest(const Rod& rod, const Eigen::Matrix3Xd& points) {
  std::vector<bool> free(static_cast<std::size_t>(points.cols()), true);
  for (const Grip& grip : rod.grips) {
    if (grip.hold == GripHold::spring) continue;
    std::fill_n(free.begin() + grip.first_point, grip.targets.cols(), false);
  }
  std::vector<Eigen::Index> rows;
  for (Eigen::Index k = 0; k < points.size(); ++k) {
    if (free[static_cast<std::size_t>(k / 3)]) rows.push_back(k);
  }
  const Eigen::MatrixXd between_free = full_stiffness(rod, points)(rows, rows);
  return between_free.eigenvalues().real().maxCoeff();
}

/// Properties of the rod of a random shape.
struct Kind {
  BendingLaw law = BendingLaw::hooke;
  double c_c = 0;
  bool equal = true;  // segments
  int grips = 0;      // a clamp; two clamps; a clamp and two pins; a clamp on springs
  bool planar = true;
  bool walls = false;
};

struct RodAndShape {
  Rod rod;
  Eigen::Matrix3Xd points;
};

RodAndShape random_shape(unsigned seed, const Kind& kind) {
  const SteelRod steel;
  const Eigen::Index n = steel.points;
  const double L = steel.segment();
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  RodAndShape result;
  result.rod = steel.rod({kind.law, kind.law == BendingLaw::hooke ? steel.EI : 3574.96}, kind.c_c);
  Rod& rod = result.rod;
  if (!kind.equal) {
    for (double& length : rod.rest_lengths) length = L * std::pow(2.5, uniform(engine));
  }
  // A random walk whose segments are up to a twentieth longer or shorter than at rest
  const Eigen::Matrix3Xd walk = random_polygon(seed, n - 1, 1, 0.05);
  result.points.setZero(3, n);
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    Eigen::Vector3d step = walk.col(i + 1) - walk.col(i);
    const double length = step.norm();
    if (kind.planar) step.z() = 0;
    result.points.col(i + 1) =
        result.points.col(i) + rod.rest_lengths[i] * length * step.normalized();
  }
  const auto hold = [&](Eigen::Index first, Eigen::Index count) {
    rod.grips.push_back({.first_point = first, .targets = result.points.middleCols(first, count)});
  };
  rod.grips.clear();
  hold(0, 2);
  if (kind.grips == 1) hold(n - 2, 2);
  if (kind.grips == 2) {
    hold(n / 2, 1);
    hold(n - 1, 1);
  }
  if (kind.grips == 3) {
    rod.grips.front().hold = GripHold::spring;
    rod.grips.front().stiffness = kind.c_c / L;
  }
  if (kind.walls) {
    rod.walls = {
        {.point = result.points.col(n / 2), .normal = {0, 1, 0}, .stiffness = kind.c_c / L},
        {.point = result.points.col(3), .normal = {0.6, -0.8, 0}, .stiffness = 2 * kind.c_c / L}};
  }
  return result;
}

// Measured over these 768 shapes: the bound is 1.12 times the largest eigenvalue at least, 3.3
// times in the median, 30 times at most: 2.6 and 12 times for equal segments, 4.2 and 30 for
// unequal ones, whose lengths differ by up to a factor of 6 from one to the next. (At rest, where
// rods are less bent, it is 1.01 to 1.83 times, see stability_map.) The test requires at
// least 1, less than 4 in the median and less than 40.
TEST(ModeBounds, FastestModeIsNeverUnderestimatedOnRandomShapes) {
  std::vector<double> ratios;
  unsigned seed = 0;
  for (const BendingLaw law : {BendingLaw::hooke, BendingLaw::paper}) {
    for (const double c_c : {10.0, 660.0, 20000.0}) {
      for (const bool equal : {true, false}) {
        for (int grips = 0; grips < 4; ++grips) {
          for (const bool planar : {true, false}) {
            for (const bool walls : {false, true}) {
              for (int repeat = 0; repeat < 4; ++repeat) {
                const RodAndShape shape =
                    random_shape(++seed, {law, c_c, equal, grips, planar, walls});
                const double bound = mode_bounds(shape.rod, shape.points).fastest;
                const double radius = measured_fastest(shape.rod, shape.points);
                ASSERT_GE(bound, radius) << "seed " << seed << ", law " << static_cast<int>(law)
                                         << ", c_c " << c_c << ", equal " << equal << ", grips "
                                         << grips << ", planar " << planar << ", walls " << walls;
                ratios.push_back(bound / radius);
              }
            }
          }
        }
      }
    }
  }
  std::sort(ratios.begin(), ratios.end());
  RecordProperty("shapes", static_cast<int>(ratios.size()));
  RecordProperty("smallest_ratio", std::to_string(ratios.front()));
  RecordProperty("median_ratio", std::to_string(ratios[ratios.size() / 2]));
  RecordProperty("largest_ratio", std::to_string(ratios.back()));
  EXPECT_GE(ratios.size(), 200U);
  EXPECT_LT(ratios[ratios.size() / 2], 4);
  EXPECT_LT(ratios.back(), 40);
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
