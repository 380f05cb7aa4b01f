// Tests of files with two errors at once: both are named, of 30 random files in at least 27.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/explanation.hpp"
#include "dlo/compare/scene_file.hpp"
#include "hinged_chain.hpp"
#include "judged_shape.hpp"

namespace dlo::compare {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Returns one of three scenes: a cantilever in the plane, one out of it, and a rod between two
/// grippers.
Scene scene_of(int kind) {
  const std::string rod = "[rod]\nlength = 0.9\nbending_stiffness = 1\nmass_per_length = 0.5\n";
  const std::string load = "[[load]]\nat = 0.9\nforce = [0, 0, 1.5]\n";
  const std::string first = "[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = ";
  const std::string last =
      "[[gripper]]\nat = 0.9\nposition = [0.6, 0.15, 0.1]\ndirection = [1, -0.5, 0.3]\n";
  switch (kind) {
    case 0:
      return parse_scene(rod + first + "\"20 deg\"\n", "plane.toml");
    case 1:
      return parse_scene(rod + first + "[1, 0.4, -0.2]\n" + load, "space.toml");
    default:
      return parse_scene(rod + first + "[1, 0.6, 0]\n" + last, "two.toml");
  }
}

Matrix3d random_axes(std::mt19937& random) {
  std::array<int, 3> order = {0, 1, 2};
  Matrix3d axes;
  do {
    std::shuffle(order.begin(), order.end(), random);
    axes.setZero();
    for (int i = 0; i < 3; ++i) {
      axes(i, order[static_cast<std::size_t>(i)]) = random() % 2 == 0 ? 1 : -1;
    }
    // The sign of the third axis has no effect on points in the scene's plane.
  } while (axes.topLeftCorner<2, 2>().isIdentity());
  return axes;
}

/// A modification of a correct file by one error.
struct Fault {
  const char* words;  ///< words that name this error and no other one
  Matrix3Xd (*apply)(const Matrix3Xd& points, std::mt19937& random);
};

constexpr Fault missing_end = {"an end point is missing",
                               [](const Matrix3Xd& points, std::mt19937& /*random*/) -> Matrix3Xd {
                                 return points.leftCols(points.cols() - 1);
                               }};
constexpr Fault other_axes = {"the scene's",
                              [](const Matrix3Xd& points, std::mt19937& random) -> Matrix3Xd {
                                return random_axes(random) * points;
                              }};
constexpr Fault other_origin = {
    "another origin", [](const Matrix3Xd& points, std::mt19937& random) -> Matrix3Xd {
      std::uniform_real_distribution<double> metres(-1, 1);
      return points.colwise() + Vector3d(metres(random), metres(random), metres(random));
    }};
constexpr Fault other_unit = {"not in metres",
                              [](const Matrix3Xd& points, std::mt19937& random) -> Matrix3Xd {
                                return points * std::array{1000.0, 100.0, 1 / 0.0254}[random() % 3];
                              }};

/// Returns the matrix from the scene's axes to those of a file with z up.
Matrix3d to_z_up() {
  return (Matrix3d() << Vector3d::UnitX(), Vector3d::UnitZ(), -Vector3d::UnitY()).finished();
}

std::vector<Explanation> explained(const Scene& scene, const MeasuredShape& shape) {
  const ShapeCheckOptions options{.modulus = ModulusSearch::no};
  return explain_shape(scene, shape, check_shape(scene, shape, options), options);
}

TEST(JointCauses, TwoThingsThatAreWrongWithAFileAreBothNamed) {
  constexpr std::array<std::array<Fault, 2>, 6> pairs = {{{missing_end, other_axes},
                                                          {other_axes, other_origin},
                                                          {other_axes, other_unit},
                                                          {missing_end, other_origin},
                                                          {other_origin, other_unit},
                                                          {missing_end, other_unit}}};
  std::mt19937 random(7);
  int named = 0;
  int tried = 0;
  for (const auto& pair : pairs) {
    for (int i = 0; i < 5; ++i, ++tried) {
      const Scene scene = scene_of(tried % 3);
      MeasuredShape shape = exact_file(scene, 9 + static_cast<int>(random() % 8));
      for (const Fault& fault : pair) shape.points = fault.apply(shape.points, random);
      const std::vector<Explanation> found = explained(scene, shape);
      const std::string best = found.empty() ? "nothing" : found.front().cause;
      bool right = !found.empty() && found.front().rms_m < 0.005 * scene.length;
      for (const Fault& fault : {missing_end, other_axes, other_origin, other_unit}) {
        const bool is_made = fault.words == pair[0].words || fault.words == pair[1].words;
        right = right && (best.find(fault.words) != std::string::npos) == is_made;
      }
      named += right ? 1 : 0;
      if (!right) fmt::print("{} and {}: {}\n", pair[0].words, pair[1].words, best);
    }
  }
  EXPECT_EQ(tried, 30);
  EXPECT_GE(named, 27);
}

// A file with z up that is also translated must not be explained as "z is down" or as two exchanged
// axes.
TEST(JointCauses, AMovedFileWithZUpIsCalledThat) {
  const Scene scene = scene_of(0);
  for (const double height : {1.0, 0.3}) {
    const MeasuredShape shape =
        file_shape((to_z_up() * exact_file(scene).points).colwise() + Vector3d(0, 0, height));
    const std::vector<Explanation> found = explained(scene, shape);
    ASSERT_FALSE(found.empty());
    EXPECT_TRUE(
        has_all(found.front().cause,
                {"z is up in the file", fmt::format("[0, {:.4g}, 0] mm away", -1e3 * height)}));
    EXPECT_LT(found.front().rms_m, 1e-4 * scene.length);
  }
}

// A file of body positions has the begins of all segments, but not the end of the last segment.
TEST(JointCauses, AChainOfBodiesWhoseLastEndIsMissingIsCalledThat) {
  constexpr int segments = 8;
  const Matrix3Xd chain =
      test::hinged_chain(std::vector<double>(segments, 1.0 / segments), 1.0 / segments, 1, false)
          .leftCols(segments);
  const std::vector<Explanation> found = explained(clamped(), file_shape(chain));
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().cause,
            "a chain of 8 segments with a hinge at the clamp, its last end missing as in MuJoCo's "
            "xpos, its springs EI/h and linear in the angle");
  EXPECT_LT(found.front().rms_m, 1e-3);
  const std::vector<Explanation> both = explained(clamped(), file_shape(to_z_up() * chain));
  ASSERT_FALSE(both.empty());
  EXPECT_TRUE(
      has_all(both.front().cause, {"z is up in the file", "a chain of 8 segments", "xpos"}));
}

}  // namespace
}  // namespace dlo::compare
