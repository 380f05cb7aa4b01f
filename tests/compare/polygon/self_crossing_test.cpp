#include "polygon/self_crossing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace dlo::compare {
namespace {

using std::numbers::pi;

/// Points of a curve of unit speed.
Shape curve(double length, int count, const std::function<Eigen::Vector3d(double)>& at) {
  Shape shape;
  shape.arc_length = equal_arc_lengths(length, count);
  shape.points.resize(3, count);
  for (int i = 0; i < count; ++i) {
    shape.points.col(i) = at(shape.arc_length[static_cast<std::size_t>(i)]);
  }
  return shape;
}

/// Of radius 1, rising by `rise` a turn.
Shape coil(double turns, double rise) {
  const double length = turns * std::hypot(2 * pi, rise);
  return curve(length, 401, [=](double s) {
    const double angle = 2 * pi * turns * s / length;
    return Eigen::Vector3d(std::cos(angle), std::sin(angle), rise * angle / (2 * pi));
  });
}

TEST(SelfCrossing, IsWhereAxesComeNearerThanTheRodIsThick) {
  const auto crossing = self_crossing(coil(1.25, 0.1), 0.11);
  ASSERT_TRUE(crossing);
  EXPECT_NEAR(crossing->distance, 0.1, 1e-3);
  EXPECT_NEAR(crossing->second - crossing->first, 2 * pi, 0.03);
  EXPECT_FALSE(self_crossing(coil(1.25, 0.1), 0.09));
  EXPECT_FALSE(self_crossing(coil(0.9, 0), 0.1));
}

TEST(SelfCrossing, IsFoundBetweenPointsOfALoopWithoutThickness) {
  // Two straight legs that a loop joins: they cross at (1, 0), in the middle of segments.
  Shape shape;
  shape.arc_length = {0, 2, 3, 4.5, 6};
  shape.points.resize(3, 5);
  shape.points << 0, 2, 2, 1, 1, 0, 0, 1, 1, -1, 0, 0, 0, 0, 0;
  const auto crossing = self_crossing(shape, 0);
  ASSERT_TRUE(crossing);
  EXPECT_DOUBLE_EQ(crossing->first, 1);
  EXPECT_DOUBLE_EQ(crossing->second, 5.25);
  EXPECT_EQ(crossing->distance, 0);
  shape.points.row(2) << 0, 0, 0, 0.2, 0.2;
  EXPECT_FALSE(self_crossing(shape, 0));
  EXPECT_FALSE(self_crossing(shape, 0.19));
  EXPECT_TRUE(self_crossing(shape, 0.21));
}

TEST(SelfCrossing, BendsAreNone) {
  const Shape straight = curve(1, 101, [](double s) { return Eigen::Vector3d(s, 0, 0); });
  EXPECT_FALSE(self_crossing(straight, 0.1));
  // Half a circle as tight as the rod allows, with its ends apart by a little more than it is
  // thick.
  const double radius = 0.051;
  const Shape bend = curve(pi * radius, 101, [=](double s) -> Eigen::Vector3d {
    return radius * Eigen::Vector3d(std::cos(s / radius), std::sin(s / radius), 0);
  });
  EXPECT_FALSE(self_crossing(bend, 0.1));
}

}  // namespace
}  // namespace dlo::compare
