#include "polygon/self_crossing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

namespace dlo::compare {
namespace {

using std::numbers::pi;

/// Returns the smallest distance over all pairs of segments without a common point, or std::nullopt
/// if no distance is at most `diameter`. A pair whose nearest points are less than three diameters
/// apart along the rod does not count. The distance of a pair is minimised alternately in the
/// position on either segment, from the middles of both.
std::optional<double> nearest_of_all_pairs(const Shape& shape, double diameter) {
  std::optional<double> nearest;
  const auto at = [&](Eigen::Index i, double share) -> Eigen::Vector3d {
    return (1 - share) * shape.points.col(i) + share * shape.points.col(i + 1);
  };
  const auto arc = [&](Eigen::Index i, double share) {
    const auto k = static_cast<std::size_t>(i);
    return (1 - share) * shape.arc_length[k] + share * shape.arc_length[k + 1];
  };
  const auto foot = [&](const Eigen::Vector3d& p, Eigen::Index i) {
    const Eigen::Vector3d along = shape.points.col(i + 1) - shape.points.col(i);
    return std::clamp(along.dot(p - shape.points.col(i)) / along.squaredNorm(), 0.0, 1.0);
  };
  for (Eigen::Index i = 0; i + 1 < shape.points.cols(); ++i) {
    for (Eigen::Index j = i + 2; j + 1 < shape.points.cols(); ++j) {
      double a = 0.5;
      double b = 0.5;
      for (int round = 0; round < 200; ++round) {
        b = foot(at(i, a), j);
        a = foot(at(j, b), i);
      }
      const double distance = (at(i, a) - at(j, b)).norm();
      if (arc(j, b) - arc(i, a) < 3 * diameter || distance > diameter) continue;
      nearest = std::min(nearest.value_or(distance), distance);
    }
  }
  return nearest;
}

// Random walks, loose and dense, with segments of unlike lengths: the same as all pairs.
TEST(SelfCrossing, OfRandomPolygonsItIsTheNearestOfAllPairs) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> anywhere(0.02, 1);
  int crossed = 0;
  for (int draw = 0; draw < 60; ++draw) {
    const int count = 5 + 3 * draw % 90;
    Shape shape;
    shape.points = Eigen::Matrix3Xd::Zero(3, count);
    shape.arc_length = {0};
    for (int i = 1; i < count; ++i) {
      const double length = anywhere(random) * (i % 7 == 0 ? 5 : 1);
      const Eigen::Vector3d way(normal(random), normal(random), draw % 3 == 0 ? 0 : normal(random));
      shape.points.col(i) = shape.points.col(i - 1) + length * way.normalized();
      shape.arc_length.push_back(shape.arc_length.back() + length);
    }
    const double diameter = 0.02 * (1 + draw % 12);
    const auto expected = nearest_of_all_pairs(shape, diameter);
    const auto found = self_crossing(shape, diameter);
    ASSERT_EQ(found.has_value(), expected.has_value()) << draw;
    if (!found) continue;
    ++crossed;
    EXPECT_NEAR(found->distance, *expected, 1e-6 * diameter) << draw;
  }
  EXPECT_GE(crossed, 20);
  EXPECT_LE(crossed, 55);
}

// If several pairs are equally near, the first along the rod is reported: rungs of a ladder that
// the rod climbs in zigzag.
TEST(SelfCrossing, OfEqualDistancesTheFirstAlongTheRodCounts) {
  Shape shape;
  shape.arc_length = equal_arc_lengths(20, 21);
  shape.points = Eigen::Matrix3Xd::Zero(3, 21);
  for (int i = 1; i < 21; ++i) {
    // Right, up, left, up.
    const Eigen::Vector3d way = i % 4 == 1   ? Eigen::Vector3d(1, 0, 0)
                                : i % 4 == 3 ? Eigen::Vector3d(-1, 0, 0)
                                             : Eigen::Vector3d(0, 0.25, 0);
    shape.points.col(i) = shape.points.col(i - 1) + way;
  }
  const auto crossing = self_crossing(shape, 0.5);
  ASSERT_TRUE(crossing);
  EXPECT_EQ(crossing->distance, 0.25);
  EXPECT_LT(crossing->first, 2);
}

// A search of all pairs of 2e5 points would compare 2e10 pairs, which takes minutes.
TEST(SelfCrossing, OfManyPointsItDoesNotLookAtAllPairs) {
  const double length = 1.25 * std::hypot(2 * pi, 0.1);
  Shape fine = {equal_arc_lengths(length, 200001), Eigen::Matrix3Xd(3, 200001)};
  for (Eigen::Index i = 0; i < fine.points.cols(); ++i) {
    const double angle = 2 * pi * 1.25 * fine.arc_length[static_cast<std::size_t>(i)] / length;
    fine.points.col(i) << std::cos(angle), std::sin(angle), 0.1 * angle / (2 * pi);
  }
  const auto begin = std::chrono::steady_clock::now();
  const auto crossing = self_crossing(fine, 0.11);
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
  ASSERT_TRUE(crossing);
  // The smallest distance of two adjacent turns of a coil is perpendicular to both: the pitch times
  // the cosine of the pitch angle.
  EXPECT_NEAR(crossing->distance, 0.1 * 2 * pi / std::hypot(2 * pi, 0.1), 1e-6);
  EXPECT_NEAR(crossing->second - crossing->first, 2 * pi, 0.03);
  EXPECT_LT(spent.count(), 10);
}

}  // namespace
}  // namespace dlo::compare
