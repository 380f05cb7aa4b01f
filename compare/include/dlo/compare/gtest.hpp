#pragma once

#include <gtest/gtest.h>

#include <ostream>
#include <sstream>
#include <string>
#include <utility>

#include "dlo/compare/check.hpp"
#include "dlo/compare/scene_file.hpp"

/// Assertions and matchers of GoogleTest for shapes, in headers only: the library itself does not
/// need GoogleTest.
///
///     EXPECT_SHAPE_NEAR(shape, load_scene("wire.toml"), 1e-3);         // 0.1 % of the length
///     EXPECT_THAT(shape, dlo::compare::IsShapeOf(scene, 1e-3));         // with gmock
///     EXPECT_SHAPE_NEAR(shape, scene, dlo::compare::of_deflection(0.05));  // of a stiff rod
///
/// `shape` is a dlo::compare::Shape (points at arc lengths, in m, in the scene's frame),
/// `tolerance` the allowed RMS deviation, divided by the rod's length. A shape is near if `dlo
/// check` would pass it; a failure prints the reason. EXPECT_SHAPE_WITHIN and IsShapeWithin compare
/// the largest distance of a point with the tolerance, as `dlo check --measure max` does.
#define EXPECT_SHAPE_NEAR(shape, scene, tolerance)                                              \
  EXPECT_PRED_FORMAT3(::dlo::compare::ShapeAssertion{::dlo::compare::shape_near}, shape, scene, \
                      tolerance)
#define ASSERT_SHAPE_NEAR(shape, scene, tolerance)                                              \
  ASSERT_PRED_FORMAT3(::dlo::compare::ShapeAssertion{::dlo::compare::shape_near}, shape, scene, \
                      tolerance)
#define EXPECT_SHAPE_WITHIN(shape, scene, tolerance)                                              \
  EXPECT_PRED_FORMAT3(::dlo::compare::ShapeAssertion{::dlo::compare::shape_within}, shape, scene, \
                      tolerance)
#define ASSERT_SHAPE_WITHIN(shape, scene, tolerance)                                              \
  ASSERT_PRED_FORMAT3(::dlo::compare::ShapeAssertion{::dlo::compare::shape_within}, shape, scene, \
                      tolerance)

namespace dlo::compare {

/// Comparison that a matcher makes: shape_near or shape_within.
using ShapeTest = ShapeTestOutcome (*)(const Shape& shape, const Scene& scene,
                                       ToleranceShare tolerance);

/// Predicate of EXPECT_SHAPE_NEAR and EXPECT_SHAPE_WITHIN.
struct ShapeAssertion {
  ShapeTest test;  ///< shape_near or shape_within

  /// Returns the outcome of the comparison, with the arguments as written in the test.
  testing::AssertionResult operator()(const char* shape_text, const char* scene_text,
                                      const char* tolerance_text, const Shape& shape,
                                      const Scene& scene, ToleranceShare tolerance) const {
    const ShapeTestOutcome result = test(shape, scene, tolerance);
    if (result.near) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << shape_text << " is not the shape of " << scene_text << " (" << scene.name
           << ") within " << tolerance_text << ":\n  " << result.explanation;
  }
};

/// Matcher that IsShapeOf and IsShapeWithin return.
class ShapeMatcher {
 public:
  /// Declares the class a matcher to GoogleTest.
  using is_gtest_matcher = void;

  /// @param tolerance  share of the length or of_deflection() [-], > 0
  ShapeMatcher(ShapeTest test, Scene scene, ToleranceShare tolerance)
      : test_(test), scene_(std::move(scene)), tolerance_(tolerance) {}

  /// Whether the shape is within the tolerance of the scene's equilibrium.
  /// @param[out] explanation  stream to which the reason is written; null: none
  bool MatchAndExplain(const Shape& shape, std::ostream* explanation) const {
    const ShapeTestOutcome result = test_(shape, scene_, tolerance_);
    if (explanation != nullptr) *explanation << result.explanation;
    return result.near;
  }
  /// Describes what is expected.
  void DescribeTo(std::ostream* out) const { *out << "is" << what(); }
  /// Describes what is not expected.
  void DescribeNegationTo(std::ostream* out) const { *out << "is not" << what(); }

 private:
  [[nodiscard]] std::string what() const {
    std::ostringstream text;
    text << " the shape of " << scene_.name << " within " << tolerance_.share * 100 << " % of "
         << (tolerance_.of_deflection ? "the deflection" : "l");
    return text.str();
  }

  ShapeTest test_;
  Scene scene_;
  ToleranceShare tolerance_;
};

// Names and interfaces that GoogleTest requires, or that match its own matchers.
/// Matches a shape by its RMS deviation: EXPECT_THAT(shape, IsShapeOf(scene, 1e-3)); see
/// shape_near.
// NOLINTNEXTLINE(readability-identifier-naming)
inline ShapeMatcher IsShapeOf(Scene scene, ToleranceShare tolerance) {
  return {shape_near, std::move(scene), tolerance};
}
/// Matches a shape by its largest deviation: EXPECT_THAT(shape, IsShapeWithin(scene, 1e-3)); see
/// shape_within.
// NOLINTNEXTLINE(readability-identifier-naming)
inline ShapeMatcher IsShapeWithin(Scene scene, ToleranceShare tolerance) {
  return {shape_within, std::move(scene), tolerance};
}

/// Prints a shape in GoogleTest's messages: its number of points instead of its bytes.
// NOLINTNEXTLINE(readability-identifier-naming)
inline void PrintTo(const Shape& shape, std::ostream* out) {
  *out << "a shape of " << shape.points.cols() << " points";
}

}  // namespace dlo::compare
