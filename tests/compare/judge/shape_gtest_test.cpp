// Tests of the matchers for users of GoogleTest: accepted shapes and messages.

#include <gmock/gmock.h>
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "dlo/compare/gtest.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "scenes.hpp"

namespace {

using dlo::compare::IsShapeOf;
using dlo::compare::IsShapeWithin;
using dlo::compare::of_deflection;
using dlo::compare::Scene;
using dlo::compare::Shape;
using dlo::compare::shape_near;
using testing::HasSubstr;
using testing::Not;

Scene bent() { return dlo::test::heavy_scene(10, 0); }

Shape exact_shape(const std::vector<double>& s) {
  return dlo::compare::solve(bent(), dlo::compare::Model::exact, {}, s).shape;
}

/// Returns the exact shape at uneven arc lengths.
Shape sparse_shape() { return exact_shape({0, 0.1, 0.35, 0.8, 1}); }

/// Returns the exact shape with enough points to determine the whole rod.
Shape dense_shape() { return exact_shape(dlo::energy_model::equal_arc_lengths(1, 101)); }

TEST(ShapeMatcher, AcceptsTheShapeAndOneWithinTheTolerance) {
  Shape shape = dense_shape();
  EXPECT_SHAPE_NEAR(shape, bent(), 1e-5);
  ASSERT_SHAPE_NEAR(shape, bent(), 1e-5);
  EXPECT_THAT(shape, IsShapeOf(bent(), 1e-5));
  EXPECT_SHAPE_WITHIN(shape, bent(), 1e-5);
  shape.points.col(80).z() += 0.0099;
  EXPECT_SHAPE_WITHIN(shape, bent(), 0.01);
  ASSERT_SHAPE_WITHIN(shape, bent(), 0.01);
  shape.points.col(80).z() += 0.0002;
  EXPECT_THAT(shape, Not(IsShapeWithin(bent(), 0.01)));
  EXPECT_THAT(shape, IsShapeOf(bent(), 0.01)) << "of the RMS, as `dlo check` has it";
}

TEST(ShapeMatcher, SaysWhereAndHowFar) {
  Shape shape = dense_shape();
  shape.points.row(2).array() = 0.025;
  EXPECT_NONFATAL_FAILURE(EXPECT_SHAPE_NEAR(shape, bent(), 0.01),
                          "shape is not the shape of bent() (heavy) within 0.01:\n"
                          "  RMS 25 mm, allowed 10 mm = 1 % of l; it would be ");
  EXPECT_NONFATAL_FAILURE(EXPECT_SHAPE_NEAR(shape, bent(), 0.01), "0.025) m instead of (");
  EXPECT_NONFATAL_FAILURE(EXPECT_SHAPE_WITHIN(shape, bent(), 0.01),
                          "largest 25 mm, allowed 10 mm = 1 % of l");
  EXPECT_NONFATAL_FAILURE(EXPECT_THAT(shape, IsShapeOf(bent(), 0.01)),
                          "is the shape of heavy within 1 % of l");
  EXPECT_NONFATAL_FAILURE(EXPECT_THAT(shape, IsShapeWithin(bent(), 0.01)), "a shape of 101 points");
}

TEST(ShapeMatcher, TakesAShareOfTheDeflection) {
  const Scene stiff = dlo::test::heavy_scene(0.08, 0);  // sags by 1 % of its length
  Shape shape = dlo::compare::solve(stiff, dlo::compare::Model::exact).shape;
  EXPECT_SHAPE_NEAR(shape, stiff, of_deflection(0.05));
  shape.points.row(1).setZero();
  const auto line = shape_near(shape, stiff, 0.01);
  EXPECT_TRUE(line.near);
  EXPECT_THAT(line.explanation, HasSubstr("not significant for stiffness or weight"));
  EXPECT_THAT(shape_near(shape, stiff, of_deflection(0.05)).explanation,
              HasSubstr("= 5 % of the deflection"));
  EXPECT_THAT(shape, Not(IsShapeWithin(stiff, of_deflection(0.05))));
  EXPECT_NONFATAL_FAILURE(EXPECT_THAT(shape, IsShapeOf(stiff, of_deflection(0.05))),
                          "is the shape of heavy within 5 % of the deflection");
}

TEST(ShapeMatcher, SaysWhatIsNoShape) {
  const auto explanation = [](const Shape& shape) {
    const auto verdict = shape_near(shape, bent(), 0.5);
    EXPECT_FALSE(verdict.near);
    return verdict.explanation;
  };
  Shape shape = sparse_shape();
  shape.points(1, 2) = NAN;
  EXPECT_THAT(explanation(shape), HasSubstr("point 3: y = nan"));
  shape = sparse_shape();
  shape.arc_length.pop_back();
  EXPECT_THAT(explanation(shape), HasSubstr("4 arc lengths of 5 points"));
  shape = sparse_shape();
  shape.arc_length[2] = 0.9;
  EXPECT_THAT(explanation(shape), HasSubstr("point 4: s = 0.8 after 0.9"));
  shape.arc_length = {0, 1, 2, 3, 4};
  EXPECT_THAT(explanation(shape), HasSubstr("point 3: s = 2 m"));
  shape.arc_length[0] = NAN;
  EXPECT_THAT(explanation(shape), HasSubstr("point 1: s = nan"));
  EXPECT_THAT(explanation({}), HasSubstr("0 points"));
}

TEST(ShapeMatcher, AllowsArcLengthsTheRoundingOfASum) {
  Shape shape = dense_shape();
  shape.arc_length.front() = -3e-8;
  shape.arc_length.back() = 1 + 4e-8;
  EXPECT_SHAPE_NEAR(shape, bent(), 1e-5);
  shape.arc_length.back() = 1 + 2e-5;
  EXPECT_THAT(shape_near(shape, bent(), 1e-5).explanation,
              HasSubstr("point 101: s = 1.00002 m (allowed: 0 to 1 m"));
}

TEST(ShapeMatcher, RefusesAToleranceThatIsNone) {
  for (const double tolerance : {0.0, -1.0, static_cast<double>(NAN)}) {
    EXPECT_THROW((void)shape_near(sparse_shape(), bent(), tolerance), std::invalid_argument);
  }
}

}  // namespace
