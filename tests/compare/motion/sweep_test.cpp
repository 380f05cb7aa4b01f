#include <gtest/gtest.h>

#include <cmath>

#include "motion/branch.hpp"

namespace dlo::compare {
namespace {

using obstacle::Body;

Eigen::Matrix3Xd polyline(const Eigen::Vector3d& begin, const Eigen::Vector3d& end) {
  constexpr int points = 5;
  Eigen::Matrix3Xd result(3, points);
  for (int i = 0; i < points; ++i) result.col(i) = begin + (end - begin) * i / (points - 1);
  return result;
}

/// A straight rod along x that moves down.
bool falls_past(const Body& body, double from, double to) {
  return sweeps_through(body, polyline({-1, from, 0}, {1, from, 0}),
                        polyline({-1, to, 0}, {1, to, 0}), inner_radius(body) / 4);
}

// Thinner than the points are apart, and than the way is long.
TEST(Sweep, MeetsWhatLiesBetweenItsPoints) {
  for (const double x : {-0.99, -0.25, 0.13, 0.77}) {
    const Body peg = Body::cylinder({x, 0, 0}, {0, 0, 1}, 0.01);
    EXPECT_TRUE(falls_past(peg, 0.7, -0.4));
    EXPECT_FALSE(falls_past(peg, 0.7, 0.01));
    EXPECT_FALSE(falls_past(peg, -0.01, -0.4));
  }
  EXPECT_FALSE(falls_past(Body::cylinder({1.02, 0, 0}, {0, 0, 1}, 0.01), 0.7, -0.4));
  EXPECT_TRUE(falls_past(Body::sphere({0.3, 0, 0.005}, 0.01), 1, -1));
  EXPECT_FALSE(falls_past(Body::sphere({0.3, 0, 0.012}, 0.01), 1, -1));
  const Body plate = Body::box({0, 0, 0}, Eigen::Matrix3d::Identity(), {0.5, 0.02, 0.5}, 0);
  EXPECT_TRUE(falls_past(plate, 0.3, -0.3));
  EXPECT_FALSE(falls_past(plate, 0.3, 0.01));
}

// A rod that slides along a surface passes through it only by its chords.
TEST(Sweep, SlidingIsNoWayThrough) {
  const Body ball = Body::sphere({0, 0, 0}, 1);
  const auto touching = [](double turn) {
    Eigen::Matrix3Xd points(3, 9);
    for (int i = 0; i < 9; ++i) {
      const double angle = 0.1 * i + turn;
      points.col(i) = Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
    }
    return points;
  };
  EXPECT_FALSE(sweeps_through(ball, touching(0), touching(1), 0.25));
  EXPECT_TRUE(sweeps_through(ball, touching(0), touching(2), 0.25));
}

}  // namespace
}  // namespace dlo::compare
