#include "dlo/force_model/heuristics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace dlo::force_model {
namespace {

using std::numbers::pi;

TEST(Heuristics, QuarterCircleForceIsFormula9) {
  // N = 4: a = pi/6, (1 - sqrt 3 / 2) sqrt((1 - sqrt 3 / 2) / 2)
  const double d = 1 - std::numbers::sqrt3 / 2;
  EXPECT_NEAR(quarter_circle_force(4), d * std::sqrt(d / 2), 1e-16);
  // Fig. 3: it falls steeply and has lost almost all influence above N = 4
  EXPECT_LT(quarter_circle_force(10) / quarter_circle_force(3), 0.02);
  EXPECT_THROW((void)quarter_circle_force(2), std::invalid_argument);
}

TEST(Heuristics, SmallestQuarterCircleIsFormula10) {
  // 90 deg turns of unit segments: a square's corner, R = 1 / (2 sin 45 deg) = 1 / sqrt 2
  const QuarterCircle circle = smallest_quarter_circle(4, 5, pi / 2);
  EXPECT_NEAR(circle.radius, 1 / std::numbers::sqrt2, 1e-15);
  EXPECT_NEAR(circle.segments, 1, 1e-15);
}

TEST(Heuristics, PointsForRadiusIsTheSmallestNumberThatReachesIt) {
  const double alpha = 0.15;
  const int points = points_for_radius(0.5, 0.1, alpha);
  EXPECT_LE(smallest_quarter_circle(0.5, points, alpha).radius, 0.1);
  EXPECT_GT(smallest_quarter_circle(0.5, points - 1, alpha).radius, 0.1);
  EXPECT_EQ(points_for_radius(0.5, 100, alpha), 5);
}

TEST(Heuristics, ContractionStiffnessIsFormulas11And12) {
  EXPECT_DOUBLE_EQ(contraction_stiffness(0.07848, 5), 1.5696);  // Table 1
  EXPECT_DOUBLE_EQ(contraction_stiffness(0.01, 9.81, 5), 1.962);
}

TEST(Heuristics, BendingStiffnessOfTable1ComesFromACosine) {
  const double alpha = 2.5 * pi / 180;
  EXPECT_NEAR(bending_stiffness(0.07848, alpha, Formula13::table_1), 3776.21457, 0.000005);
  EXPECT_NEAR(bending_stiffness(0.07848, alpha, Formula13::printed), 164.87, 0.005);
}

TEST(Heuristics, GripStiffnessIsFormula14) {
  EXPECT_DOUBLE_EQ(grip_stiffness(0.0981, 0.01 * 0.15 / 9), 0.0981 / (0.01 * 0.15 / 9));
}

TEST(Heuristics, RefuseNumbersOutOfRange) {
  EXPECT_THROW((void)contraction_stiffness(-1, 5), std::invalid_argument);
  EXPECT_THROW((void)contraction_stiffness(1, 0), std::invalid_argument);
  EXPECT_THROW((void)bending_stiffness(1, 0, Formula13::printed), std::invalid_argument);
  EXPECT_THROW((void)bending_stiffness(1, NAN, Formula13::printed), std::invalid_argument);
  EXPECT_THROW((void)grip_stiffness(1, 0), std::invalid_argument);
  EXPECT_THROW((void)smallest_quarter_circle(1, 5, 4), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::force_model
