// Files in which two things are wrong at once: both are named.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/check.hpp"
#include "dlo/compare/explanation.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/scene_file.hpp"
#include "hinged_chain.hpp"

namespace dlo::compare {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::says;

/// A cantilever in the plane, one out of it, and a rod between two grippers.
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

enum class Fault { axes, origin, ends, unit };

/// The words that name it and no other.
const char* words_for(Fault fault) {
  switch (fault) {
    case Fault::axes:
      return "the scene's";
    case Fault::origin:
      return "another origin";
    case Fault::ends:
      return "an end point is missing";
    case Fault::unit:
      break;
  }
  return "not in metres";
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

Matrix3Xd said_wrongly(Matrix3Xd points, Fault fault, std::mt19937& random) {
  std::uniform_real_distribution<double> metres(-1, 1);
  switch (fault) {
    case Fault::axes:
      return random_axes(random) * points;
    case Fault::origin:
      return points.colwise() + Vector3d(metres(random), metres(random), metres(random));
    case Fault::ends:
      return points.leftCols(points.cols() - 1);
    case Fault::unit:
      break;
  }
  return points * std::array{1000.0, 100.0, 1 / 0.0254}[random() % 3];
}

std::vector<Explanation> explained(const Scene& scene, const MeasuredShape& shape) {
  const ShapeCheckOptions options{.modulus = ModulusSearch::no};
  return explain_shape(scene, shape, check_shape(scene, shape, options), options);
}

TEST(JointCauses, TwoThingsThatAreWrongWithAFileAreBothNamed) {
  constexpr std::array<std::array<Fault, 2>, 6> pairs = {{{Fault::ends, Fault::axes},
                                                          {Fault::axes, Fault::origin},
                                                          {Fault::axes, Fault::unit},
                                                          {Fault::ends, Fault::origin},
                                                          {Fault::origin, Fault::unit},
                                                          {Fault::ends, Fault::unit}}};
  std::mt19937 random(7);
  int named = 0;
  int tried = 0;
  for (const auto& pair : pairs) {
    for (int i = 0; i < 5; ++i, ++tried) {
      const Scene scene = scene_of(tried % 3);
      const int count = 9 + static_cast<int>(random() % 8);
      MeasuredShape shape;
      shape.file = "mine.csv";
      shape.points = solve_reference(scene, Model::energy)
                         .sample(equal_arc_lengths(scene.length, count))
                         .points;
      for (const Fault fault : pair) shape.points = said_wrongly(shape.points, fault, random);
      const std::vector<Explanation> found = explained(scene, shape);
      const std::string best = found.empty() ? "nothing" : found.front().cause;
      const auto names = [&best](Fault fault) {
        return best.find(words_for(fault)) != std::string::npos;
      };
      bool right = !found.empty() && found.front().rms_m < 0.005 * scene.length;
      for (const Fault fault : {Fault::axes, Fault::origin, Fault::ends, Fault::unit}) {
        right = right && names(fault) == (fault == pair[0] || fault == pair[1]);
      }
      named += right ? 1 : 0;
      if (!right) {
        fmt::print("{} and {}: {}\n", words_for(pair[0]), words_for(pair[1]), best);
      }
    }
  }
  EXPECT_EQ(tried, 30);
  EXPECT_GE(named, 27);
}

// A file with z up that was moved as well: not "z is down", nor two axes exchanged.
TEST(JointCauses, AMovedFileWithZUpIsCalledThat) {
  const Scene scene = scene_of(0);
  MeasuredShape shape;
  shape.file = "z_up.csv";
  Matrix3d to_z_up;
  to_z_up << Vector3d::UnitX(), Vector3d::UnitZ(), -Vector3d::UnitY();
  for (const double height : {1.0, 0.3}) {
    shape.points =
        (to_z_up *
         solve_reference(scene, Model::energy).sample(equal_arc_lengths(scene.length, 31)).points)
            .colwise() +
        Vector3d(0, 0, height);
    const std::vector<Explanation> found = explained(scene, shape);
    ASSERT_FALSE(found.empty());
    EXPECT_TRUE(says(found.front().cause, {"z is up in the file",
                                           fmt::format("[0, {:.4g}, 0] mm away", -1e3 * height)}));
    EXPECT_LT(found.front().rms_m, 1e-4 * scene.length);
  }
}

// An error that is not the file's is not attributed to the file, however many possible errors of a
// file there are.
TEST(JointCauses, AnotherSceneIsNoFaultOfTheFile) {
  for (const int kind : {0, 1, 2}) {
    const Scene scene = scene_of(kind);
    for (const double factor : {0.3, 0.7, 2.0}) {
      Scene other = scene;
      other.scale_modulus(factor);
      MeasuredShape shape;
      shape.file = "soft.csv";
      shape.points =
          solve_reference(other, Model::energy).sample(equal_arc_lengths(scene.length, 31)).points;
      const std::vector<Explanation> found = explained(scene, shape);
      ASSERT_FALSE(found.empty());
      EXPECT_EQ(found.front().kind, ExplanationKind::scene) << found.front().cause;
    }
  }
}

/// Returns the scene of hinged_chain().
Scene hinged_scene(const std::string& more = "") {
  return parse_scene(
      "[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 0.5\n[[gripper]]\nat = 0\n"
      "position = [0, 0, 0]\ndirection = \"20 deg\"\n" +
          more,
      "clamped.toml");
}

// Its bodies begin at its hinges, and where the last one ends is no body's begin.
TEST(JointCauses, AChainOfBodiesWhoseLastEndIsMissingIsCalledThat) {
  constexpr int segments = 8;
  const Eigen::Matrix3Xd chain =
      test::hinged_chain(std::vector<double>(segments, 1.0 / segments), 1.0 / segments, 1, false);
  MeasuredShape shape;
  shape.file = "xpos.csv";
  shape.points = chain.leftCols(segments);
  const std::vector<Explanation> found = explained(hinged_scene(), shape);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().cause,
            "a chain of 8 segments with a hinge at the clamp, its last end missing as in MuJoCo's "
            "xpos, its springs EI/h and linear in the angle");
  EXPECT_LT(found.front().rms_m, 1e-3);
  // And in a file with z up.
  Matrix3d to_z_up;
  to_z_up << Vector3d::UnitX(), Vector3d::UnitZ(), -Vector3d::UnitY();
  shape.points = (to_z_up * shape.points).eval();
  const std::vector<Explanation> both = explained(hinged_scene(), shape);
  ASSERT_FALSE(both.empty());
  EXPECT_TRUE(says(both.front().cause, {"z is up in the file", "a chain of 8 segments", "xpos"}));
}

// A floor acts on the end of a chain like the force that keeps it on the floor.
TEST(JointCauses, AChainOnAFloorIsRightInItsOwnWay) {
  const auto chain = [](double lift) {
    return test::hinged_chain(std::vector<double>(10, 0.1), 0.1, 1, false, lift);
  };
  const double height = chain(0)(1, 10) + 0.1;
  double low = 0;
  double high = 5;
  for (int i = 0; i < 60; ++i) {
    const double lift = (low + high) / 2;
    (chain(lift)(1, 10) < height ? low : high) = lift;
  }
  const Matrix3Xd points = chain(low);
  ASSERT_GT(points.leftCols(10).row(1).minCoeff(), height);
  const Scene scene = hinged_scene(
      fmt::format("[[obstacle]]\npoint = [0, {:.17g}, 0]\nnormal = [0, 1, 0]\n", height));
  MeasuredShape shape;
  shape.file = "floor.csv";
  shape.points = points;
  const CheckResult result = check(
      scene, shape,
      {.tolerance = ShapeTolerance{.allowed_m = 0.01}, .shape = {.modulus = ModulusSearch::no}});
  EXPECT_TRUE(result.passes()) << result.judgement.reason;
  EXPECT_TRUE(says(result.judgement.reason, {"right for a chain of 10 segments with a hinge"}));
}

}  // namespace
}  // namespace dlo::compare
