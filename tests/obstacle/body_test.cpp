#include "dlo/obstacle/body.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <vector>

namespace dlo::obstacle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d turned() {
  return Eigen::AngleAxisd(0.7, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
}

std::vector<Body> bodies() {
  return {Body::half_space({0.1, 0.2, 0.3}, {0.3, 1, -0.2}),
          Body::half_space({0.1, 0.2, 0.3}, {0.3, 1, -0.2}).enlarged(0.05),
          Body::sphere({0.1, -0.2, 0.1}, 0.3),
          Body::cylinder({0.1, -0.2, 0.1}, {1, 1, 3}, 0.2),
          Body::capsule({0.1, -0.2, 0.1}, {1, 1, 3}, 0.5, 0.2),
          Body::box({0.1, -0.2, 0.1}, turned(), {0.4, 0.6, 0.8}, 0.05),
          Body::box({0.1, -0.2, 0.1}, turned(), {0.4, 0.6, 0.8}, 0).enlarged(0.02)};
}

TEST(Body, DistancesAreThoseOfGeometry) {
  EXPECT_DOUBLE_EQ(Body::half_space({0, 1, 0}, {0, 2, 0}).clearance({5, 3, 7}), 2);
  EXPECT_DOUBLE_EQ(Body::half_space({0, 1, 0}, {0, 2, 0}).clearance({5, -3, 7}), -4);
  EXPECT_DOUBLE_EQ(Body::sphere({1, 0, 0}, 0.5).clearance({1, 3, 4}), 4.5);
  EXPECT_DOUBLE_EQ(Body::cylinder({1, 0, 9}, {0, 0, -2}, 0.5).clearance({4, 4, -100}), 4.5);
  const Body capsule = Body::capsule({0, 0, 0}, {1, 0, 0}, 2, 0.5);
  EXPECT_DOUBLE_EQ(capsule.clearance({0.3, 2, 0}), 1.5);
  EXPECT_DOUBLE_EQ(capsule.clearance({4, 4, 0}), 4.5);
  // The rounded edges are inside the given size of a box.
  const Body box = Body::box({0, 0, 0}, Matrix3d::Identity(), {2, 4, 6}, 0.25);
  EXPECT_DOUBLE_EQ(box.clearance({1.5, 0, 0}), 0.5);
  EXPECT_DOUBLE_EQ(box.clearance({0, -2.5, 1}), 0.5);
  EXPECT_DOUBLE_EQ(box.clearance({0.75 + 3, 1.75 + 4, 0}), 4.75);
  EXPECT_DOUBLE_EQ(box.clearance({0.5, 0, 0}), -0.5);
  EXPECT_EQ(Body::box({0, 0, 0}, Matrix3d::Identity(), {2, 4, 6}, 0).smallest_radius(), 0);
}

// Derivatives are compared with second-order differences, outside each body and up to half of its
// radius inside.
TEST(Body, DerivativesAreDifferences) {
  constexpr double h = 1e-4;
  for (const Body& body : bodies()) {
    for (int k = 0; k < 40; ++k) {
      const Vector3d point(std::sin(3.1 * k), std::sin(1.7 * k + 1), std::cos(2.3 * k));
      const Gap gap = body.gap(point);
      EXPECT_DOUBLE_EQ(gap.value, body.clearance(point));
      if (gap.value < -0.5 * body.radius()) continue;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const Vector3d step = h * Vector3d::Unit(axis);
        const Gap up = body.gap(point + step);
        const Gap down = body.gap(point - step);
        if (body.feature(point + step) != body.feature(point - step)) continue;
        EXPECT_NEAR((up.value - down.value) / (2 * h), gap.gradient[axis], 1e-6);
        EXPECT_LT(((up.gradient - down.gradient) / (2 * h) - gap.hessian.col(axis)).norm(), 1e-4);
      }
      EXPECT_NEAR(gap.gradient.norm(), 1, 1e-14);
    }
  }
}

// In a plane through a ball's centre, or at the end of a capsule, the surface is curved out of the
// plane too.
TEST(Body, BendsOutOfThePlanesThatHalveIt) {
  const Eigen::Matrix3d level = Eigen::Vector3d(0.5, 0, 0.5).asDiagonal();
  const Body ball = Body::sphere({0, 0, 0}, 1);
  EXPECT_TRUE(ball.gap({0, 2, 0}).hessian.isApprox(level, 1e-15));
  const Body capsule = Body::capsule({0, -1, 0}, {0, 1, 0}, 2, 1);
  EXPECT_TRUE(capsule.gap({0, 2, 0}).hessian.isApprox(level, 1e-15));
  const Body cylinder = Body::cylinder({0, 0, 0}, {0, 0, 1}, 1);
  const Eigen::Matrix3d round = Eigen::Vector3d(0.5, 0, 0).asDiagonal();
  EXPECT_TRUE(cylinder.gap({0, 2, 0}).hessian.isApprox(round, 1e-15));
}

TEST(Body, ManyClearancesAreThoseOfEach) {
  Eigen::Matrix3Xd points(3, 20);
  for (Eigen::Index i = 0; i < 20; ++i) {
    const auto k = static_cast<double>(i);
    points.col(i) = Vector3d(std::sin(k), std::cos(2 * k), std::sin(3 * k));
  }
  for (const Body& body : bodies()) {
    const Eigen::VectorXd all = body.clearances(points);
    for (Eigen::Index i = 0; i < 20; ++i) {
      EXPECT_NEAR(all[i], body.clearance(points.col(i)), 1e-15);
    }
  }
}

TEST(Body, DistancesAreInvariantUnderTransformation) {
  const Matrix3d turn = turned();
  const Vector3d origin(0.4, -0.3, 0.2);
  constexpr double unit = 0.5;
  const Vector3d point(0.3, 0.9, -0.8);
  for (const Body& body : bodies()) {
    const Body transformed = body.transformed(origin, turn, unit);
    EXPECT_NEAR(transformed.clearance(turn * (point - origin) / unit), body.clearance(point) / unit,
                1e-14);
    EXPECT_NEAR(body.enlarged(0.1).clearance(point), body.clearance(point) - 0.1, 1e-15);
  }
}

TEST(Body, IsItsMirrorImageInPlanesThatHalveIt) {
  const Vector3d z = Vector3d::UnitZ();
  const Vector3d zero = Vector3d::Zero();
  EXPECT_TRUE(Body::half_space({0, 0, 5}, {1, 2, 0}).is_symmetric(zero, z, 1));
  EXPECT_FALSE(Body::half_space({0, 0, 5}, {1, 2, 1e-3}).is_symmetric(zero, z, 1));
  EXPECT_TRUE(Body::sphere({3, 2, 0}, 1).is_symmetric(zero, z, 1));
  EXPECT_FALSE(Body::sphere({3, 2, 1e-3}, 1).is_symmetric(zero, z, 1));
  EXPECT_TRUE(Body::cylinder({3, 2, 7}, {0, 0, -1}, 1).is_symmetric(zero, z, 1));
  EXPECT_TRUE(Body::cylinder({3, 2, 0}, {1, 4, 0}, 1).is_symmetric(zero, z, 1));
  EXPECT_FALSE(Body::cylinder({3, 2, 0}, {1, 4, 1}, 1).is_symmetric(zero, z, 1));
  EXPECT_FALSE(Body::capsule({3, 2, 7}, {0, 0, 1}, 1, 1).is_symmetric(zero, z, 1));
  EXPECT_TRUE(Body::capsule({3, 2, 0}, {0, 0, 1}, 1, 1).is_symmetric(zero, z, 1));
  EXPECT_TRUE(Body::box({3, 2, 0}, Matrix3d::Identity(), {1, 2, 3}, 0).is_symmetric(zero, z, 1));
  EXPECT_FALSE(Body::box({3, 2, 0}, turned(), {1, 2, 3}, 0).is_symmetric(zero, z, 1));
}

TEST(Body, FeaturesAreFacesEdgesAndCorners) {
  const Body box = Body::box({0, 0, 0}, Matrix3d::Identity(), {2, 2, 2}, 0.1);
  EXPECT_EQ(box.feature({0, 2, 0}), box.feature({0.5, 0.95, 0.3}));
  EXPECT_NE(box.feature({0, 2, 0}), box.feature({0, -2, 0}));
  EXPECT_NE(box.feature({0, 2, 0}), box.feature({2, 2, 0}));
  EXPECT_NE(box.feature({2, 2, 0}), box.feature({2, 2, 2}));
  const Body ball = Body::sphere({0, 0, 0}, 1);
  EXPECT_EQ(ball.feature({1, 2, 3}), ball.feature({-1, -2, 0}));
}

// A body that is rounded with a larger radius stays inside the original body.
TEST(Body, RoundedIsWithinItself) {
  const Body box = Body::box({0.1, 0, 0}, turned(), {0.4, 0.6, 0.8}, 0.05);
  for (int k = 0; k < 40; ++k) {
    const Vector3d point(std::sin(3.1 * k), std::sin(1.7 * k + 1), std::cos(2.3 * k));
    double last = box.clearance(point);
    for (const double share : {0.25, 0.5, 1.0}) {
      const double now = box.with_rounded_edges(share).clearance(point);
      EXPECT_TRUE(last <= 0 || now >= last - 1e-14);
      last = now;
    }
  }
  EXPECT_NEAR(box.with_rounded_edges(1).radius(), 0.2, 1e-15);
}

TEST(Body, SamplesFollowItsSmallestRadius) {
  EXPECT_EQ(samples_per_segment(Body::half_space({0, 0, 0}, {0, 1, 0}), 1), 1);
  EXPECT_EQ(samples_per_segment(Body::sphere({0, 0, 0}, 2), 1), 1);
  EXPECT_EQ(samples_per_segment(Body::sphere({0, 0, 0}, 0.5), 1), 4);
  EXPECT_EQ(samples_per_segment(Body::sphere({0, 0, 0}, 1e-6), 1), 16);
}

}  // namespace
}  // namespace dlo::obstacle
