#include "dlo/obstacle/outline.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

namespace dlo::obstacle {
namespace {

constexpr double far_away = 50;

Eigen::Matrix2Xd seen_along_z(const Body& body) {
  return outline(body, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), far_away);
}

double enclosed_area(const Eigen::Matrix2Xd& points) {
  double twice = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector2d a = points.col(i);
    const Eigen::Vector2d b = points.col((i + 1) % points.cols());
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

// If a body is symmetric about the plane of the plot, its outline is its section: all points are on
// the surface, and the enclosed area is that of the section, less the segments that chords cut off.
TEST(Outline, IsTheSurfaceInAPlaneOfSymmetry) {
  const Eigen::Vector3d middle(0.3, -0.2, 0);
  const double r = 0.1;
  const Eigen::Matrix3d turned =
      Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const double disc = M_PI * r * r;
  const struct {
    Body body;
    double area;
  } cases[] = {
      {Body::sphere(middle, r), disc},
      {Body::cylinder(middle, Eigen::Vector3d::UnitZ(), r), disc},
      {Body::capsule(middle, {1, 2, 0}, 0.7, r), disc + 2 * r * 0.7},
      {Body::box(middle, turned, {0.6, 0.4, 0.5}, r), 0.6 * 0.4 - (4 * r * r - disc)},
      {Body::box(middle, turned, {0.6, 0.4, 0.5}, 0), 0.6 * 0.4},
  };
  for (const auto& [body, area] : cases) {
    const Eigen::Matrix2Xd points = seen_along_z(body);
    Eigen::Matrix3Xd in_space = Eigen::Matrix3Xd::Zero(3, points.cols());
    in_space.topRows<2>() = points;
    EXPECT_LT(body.clearances(in_space).cwiseAbs().maxCoeff(), 1e-12);
    // The segment that the chord of an angle a cuts off has a^2 / 6 of the area of its sector.
    const double chords = std::pow(2 * M_PI / 120, 2) / 6 * disc;
    EXPECT_NEAR(enclosed_area(points), area, chords + 1e-12);
  }
}

TEST(Outline, OfAnInfiniteBodyExtendsFar) {
  const Eigen::Vector3d normal = Eigen::Vector3d(-1, 2, 0).normalized();
  const Body slope = Body::half_space({0.5, 0.1, 7}, normal).enlarged(0.02);
  const Eigen::Matrix2Xd points = seen_along_z(slope);
  Eigen::Index on_edge = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const double height = slope.clearance({points(0, i), points(1, i), 0});
    EXPECT_LT(height, 1e-9);
    if (height > -1e-9) ++on_edge;
  }
  EXPECT_GE(on_edge, 2);
  EXPECT_GT(enclosed_area(points), far_away * far_away);
  const Eigen::Matrix2Xd peg =
      seen_along_z(Body::cylinder({0, 0, 0}, Eigen::Vector3d::UnitX(), 0.1));
  EXPECT_NEAR(peg.row(1).maxCoeff(), 0.1, 1e-12);
  EXPECT_NEAR(peg.row(0).maxCoeff(), far_away + 0.1, 1e-12);
}

// A half-space has an outline only if its surface is seen edge-on.
TEST(Outline, IsEmptyWhereAHalfSpaceHasNoEdge) {
  EXPECT_EQ(seen_along_z(Body::half_space({0, 0, -1}, {0, 0, 1})).cols(), 0);
  EXPECT_EQ(seen_along_z(Body::half_space({0, 0, -1}, {0, 1, 1})).cols(), 0);
}

}  // namespace
}  // namespace dlo::obstacle
