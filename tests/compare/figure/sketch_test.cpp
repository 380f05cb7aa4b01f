#include "figure/sketch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "dlo/compare/scene.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

SketchLine line(std::initializer_list<Eigen::Vector2d> points, bool joined = true) {
  SketchLine result{.points = Eigen::Matrix2Xd(2, static_cast<Eigen::Index>(points.size())),
                    .joined = joined};
  Eigen::Index i = 0;
  for (const Eigen::Vector2d& point : points) result.points.col(i++) = point;
  return result;
}

TEST(Sketch, SetsTheDotsOfUnicode) {
  // A box of one character: the dots 1, 8 (corners) and the diagonal between them.
  EXPECT_EQ(sketch({line({{0, 3}, {1, 0}}, false)}, 1, 1, SketchMarks::braille), "\u2881\n");
  EXPECT_EQ(sketch({line({{0, 0}, {0, 3}})}, 1, 1, SketchMarks::braille), "\u2847\n");
  EXPECT_EQ(sketch({line({{0, 0}, {0, 1}})}, 1, 1, SketchMarks::ascii), ":\n");
}

TEST(Sketch, HasOneScaleForBothDirections) {
  // A square is twice as many characters wide as high, however wide the box is.
  const SketchLine square = line({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}});
  for (const SketchMarks marks : {SketchMarks::ascii, SketchMarks::braille}) {
    const auto lines = lines_of(sketch({square}, 60, 10, marks));
    ASSERT_EQ(lines.size(), 10U);
    const std::size_t bytes = marks == SketchMarks::braille ? 3 : 1;
    EXPECT_EQ(lines.front().size(), 20 * bytes);
    EXPECT_EQ(lines.back().size(), 20 * bytes);
  }
  EXPECT_EQ(lines_of(sketch({square}, 12, 40, SketchMarks::ascii)).size(), 6U);
}

TEST(Sketch, FitsIntoItsBoxAndKeepsUpUp) {
  SketchLine arc;
  arc.points.resize(2, 50);
  for (int i = 0; i < 50; ++i) {
    const double angle = i * std::acos(-1.0) / 49;
    arc.points.col(i) << std::cos(angle), std::sin(angle);
  }
  const auto lines = lines_of(sketch({arc}, 31, 9, SketchMarks::ascii));
  ASSERT_LE(lines.size(), 9U);
  for (const std::string& text : lines) EXPECT_LE(text.size(), 31U);
  // Its top is in the middle, its ends are at the sides below.
  const std::size_t middle = lines.front().find_first_not_of(' ');
  EXPECT_GT(middle, 3U);
  EXPECT_NE(lines.back().front(), ' ');
}

TEST(Sketch, TakesWhatHasNoExtent) {
  EXPECT_EQ(sketch({line({{2, 5}})}, 40, 10, SketchMarks::ascii), "'\n");
  EXPECT_EQ(sketch({line({{0, 1}, {1, 1}})}, 4, 10, SketchMarks::ascii), "''''\n");
  EXPECT_EQ(sketch({line({{1, 0}, {1, 1}})}, 40, 2, SketchMarks::ascii), ":\n:\n");
}

TEST(Sketch, SeesAPlaneAsItLies) {
  // In the plane y-z with gravity along -z: y to the right, z up.
  Scene scene = test::heavy_scene(2, 0);
  scene.gravity = {0, 0, -9.81};
  scene.grippers.front().direction = Eigen::Vector3d::UnitY();
  SpatialLine rod;
  rod.points.resize(3, 2);
  rod.points.col(0) << 0, 0, 0;
  rod.points.col(1) << 0, 1, -1;
  const auto lines = lines_of(sketch_of(scene, {rod}, 20, 5, SketchMarks::ascii));
  ASSERT_EQ(lines.size(), 6U);
  EXPECT_EQ(lines.front(), "y to the right, 0 to 1 m; z up, -1 to 0 m");
  EXPECT_EQ(lines[1].front(), '\'');
  EXPECT_EQ(lines[5].size(), 10U);
}

}  // namespace
}  // namespace dlo::compare
