#include "dlo/compare/shape.hpp"

#include <gtest/gtest.h>

#include "dlo/compare/deviation.hpp"

namespace dlo::compare {
namespace {

TEST(Shape, ResamplesOnStraightLines) {
  Shape shape;
  shape.arc_length = {0, 1, 3};
  shape.points.resize(3, 3);
  shape.points << 0, 1, 1, 0, 0, 2, 0, 0, 0;
  const Shape result = resample(shape, {0, 0.5, 1, 2, 3});
  Eigen::Matrix3Xd expected(3, 5);
  expected << 0, 0.5, 1, 1, 1, 0, 0, 0, 1, 2, 0, 0, 0, 0, 0;
  EXPECT_LT((result.points - expected).norm(), 1e-15);
  EXPECT_THROW((void)resample({{0}, Eigen::Matrix3Xd::Zero(3, 1)}, {0}), std::invalid_argument);
}

TEST(Shape, EqualArcLengthsEndExactlyAtTheLength) {
  const std::vector<double> s = equal_arc_lengths(0.3, 8);
  EXPECT_EQ(s.front(), 0);
  EXPECT_EQ(s.back(), 0.3);
  EXPECT_THROW((void)equal_arc_lengths(0.3, 1), std::invalid_argument);
}

TEST(Rms, IsTheIntegralOverTheArcLength) {
  // |d|^2 is 0, 1, 1 at s = 0, 1, 3: trapezoids 0.5 + 2 over a length of 3
  Eigen::Matrix3Xd difference = Eigen::Matrix3Xd::Zero(3, 3);
  difference(1, 1) = 1;
  difference(0, 2) = -1;
  EXPECT_DOUBLE_EQ(rms({0, 1, 3}, difference), std::sqrt(2.5 / 3));
}

}  // namespace
}  // namespace dlo::compare
