#pragma once

#include <gtest/gtest.h>

#include <ostream>
#include <utility>

#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/shape_verdict.hpp"

/// GoogleTest for shapes; headers only, the library itself does not need GoogleTest.
///
///     EXPECT_SHAPE_NEAR(shape, load_scene("wire.toml"), 1e-3);         // 0.1 % of the length
///     EXPECT_THAT(shape, dlo::compare::IsShapeOf(scene, 1e-3));         // with gmock
///
/// `shape` is a dlo::compare::Shape (points at arc lengths, in m, in the scene's frame),
/// `tolerance` the largest distance at equal arc length that is allowed, as a share of the rod's
/// length. A failure says where the shape is furthest away and how far.
#define EXPECT_SHAPE_NEAR(shape, scene, tolerance) \
  EXPECT_PRED_FORMAT3(::dlo::compare::assert_shape_near, shape, scene, tolerance)
#define ASSERT_SHAPE_NEAR(shape, scene, tolerance) \
  ASSERT_PRED_FORMAT3(::dlo::compare::assert_shape_near, shape, scene, tolerance)

namespace dlo::compare {

/// What EXPECT_SHAPE_NEAR calls: the texts are the arguments as written.
inline testing::AssertionResult assert_shape_near(const char* shape_text, const char* scene_text,
                                                  const char* tolerance_text, const Shape& shape,
                                                  const Scene& scene, double tolerance) {
  const ShapeNear result = shape_near(shape, scene, tolerance);
  if (result.near) return testing::AssertionSuccess();
  return testing::AssertionFailure()
         << shape_text << " is not the shape of " << scene_text << " (" << scene.name << ") within "
         << tolerance_text << ":\n  " << result.explanation;
}

/// What IsShapeOf gives.
class ShapeMatcher {
 public:
  /// for GoogleTest
  using is_gtest_matcher = void;

  /// @param tolerance  largest distance of a point, share of the length [-], > 0
  ShapeMatcher(Scene scene, double tolerance) : scene_(std::move(scene)), tolerance_(tolerance) {}

  /// Whether the shape is the scene's; streams where it is worst.
  bool MatchAndExplain(const Shape& shape, std::ostream* explanation) const {
    const ShapeNear result = shape_near(shape, scene_, tolerance_);
    if (explanation != nullptr) *explanation << result.explanation;
    return result.near;
  }
  /// What is expected.
  void DescribeTo(std::ostream* out) const {
    *out << "is the shape of " << scene_.name << " within " << tolerance_ * 100 << " % of l";
  }
  /// What is not expected.
  void DescribeNegationTo(std::ostream* out) const {
    *out << "is not the shape of " << scene_.name << " within " << tolerance_ * 100 << " % of l";
  }

 private:
  Scene scene_;
  double tolerance_;
};

// GoogleTest's names for what GoogleTest calls and for what stands beside its matchers.
/// EXPECT_THAT(shape, IsShapeOf(scene, 1e-3)): see shape_near.
// NOLINTNEXTLINE(readability-identifier-naming)
inline ShapeMatcher IsShapeOf(Scene scene, double tolerance) {
  return {std::move(scene), tolerance};
}

/// How GoogleTest prints a shape: its size, not its bytes.
// NOLINTNEXTLINE(readability-identifier-naming)
inline void PrintTo(const Shape& shape, std::ostream* out) {
  *out << "a shape of " << shape.points.cols() << " points";
}

}  // namespace dlo::compare
