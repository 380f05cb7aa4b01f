// Tests of obstacles: accepted and refused keys of a file.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene_file.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

const std::string over_a_rod = "[rod]\nlength = 1\ndiameter = 0.02\nmaterial = \"silicone\"\n" +
                               test::level_clamp + "[[obstacle]]\n";

/// Returns the clearance of a point from an obstacle at [0, -1, 0] with these keys.
double clearance(const std::string& shape, const std::string& keys, const Eigen::Vector3d& point) {
  const std::string text = "shape = \"" + shape + "\"\npoint = [0, -1, 0]\n" + keys;
  return parse_scene(over_a_rod + text, "my.toml").obstacles.at(0).body.clearance(point);
}

void expect_refused(const std::string& keys, const std::vector<std::string>& parts) {
  EXPECT_TRUE(has_all(test::scene_error(over_a_rod + keys), parts));
}

// The rod's axis stays half of its diameter, 10 mm, away from an obstacle that its surface touches.
TEST(SceneObstacle, HasTheBodyThatTheFileSays) {
  const std::string normal = "normal = [0, 1, 0]\n";
  EXPECT_NEAR(clearance("plane", normal, {3, 2, 1}), 2.99, 1e-12);
  EXPECT_NEAR(clearance("plane", normal + "touches = \"axis\"\n", {3, 2, 1}), 3, 1e-12);
  EXPECT_NEAR(clearance("sphere", "radius = \"20 cm\"\n", {0, 2, 4}), 4.79, 1e-12);
  const std::string axis = "axis = [0, 0, 5]\nradius = 0.2\n";
  EXPECT_NEAR(clearance("cylinder", axis, {4, 2, 77}), 4.79, 1e-12);
  EXPECT_NEAR(clearance("capsule", axis + "length = 2\n", {0, 2, 5}), 4.79, 1e-12);
  const std::string size = "size = [0.2, 0.4, 0.6]\n";
  EXPECT_NEAR(clearance("box", size, {0.05, 0, 0.1}), 0.79, 1e-12);
  EXPECT_NEAR(clearance("box", size + "axis = [0, 0, 1]\n", {1, -1, 0}), 0.69, 1e-12);
  EXPECT_NEAR(clearance("box", size + "axis = [1, 1, 0]\nnormal = [-1, 1, 0]\n", {0, -1, 1}), 0.69,
              1e-12);
  // 20 mm round: 80 and 180 mm to the middle of the edge's roundness.
  EXPECT_NEAR(clearance("box", size + "radius = 0.02\n", {0.08 + 3, -1 + 0.18 + 4, 0}), 5 - 0.03,
              1e-12);
}

TEST(SceneObstacle, HasFrictionOnlyIfTheFileSaysSo) {
  const std::string floor = "point = [0, -1, 0]\nnormal = [0, 1, 0]\n";
  const auto friction = [&](const std::string& keys) {
    return parse_scene(over_a_rod + floor + keys, "my.toml").obstacles.at(0).friction;
  };
  EXPECT_EQ(friction(""), 0);
  EXPECT_EQ(friction("friction = 0\n"), 0);
  EXPECT_EQ(friction("friction = 1.5\n"), 1.5);
  expect_refused(floor + "friction = -0.3\n", {"my.toml:12: ", "friction = -0.3", ">= 0"});
  expect_refused(floor + "friction = \"0.3 N\"\n", {"my.toml:12: ", "friction"});
}

TEST(SceneObstacle, IsRefusedWithWhatIsAllowed) {
  expect_refused("shape = \"cone\"\npoint = [0, -1, 0]\n",
                 {"my.toml:10: obstacle.shape", "'cone'", "cylinder", "box"});
  expect_refused("shape = \"sphere\"\npoint = [0, -1, 0]\n", {"obstacle.radius", "missing"});
  expect_refused("shape = \"sphere\"\npoint = [0, -1, 0]\nradius = 1\nnormal = [0, 1, 0]\n",
                 {"my.toml:13: obstacle.normal"});
  expect_refused("shape = \"sphere\"\npoint = [0, -0.1, 0]\nradius = 0.2\n",
                 {"gripper.position", "within an obstacle"});
  expect_refused("shape = \"cylinder\"\npoint = [0, -1, 0]\naxis = [0, 0, 0]\nradius = 1\n",
                 {"obstacle.axis", "zero vector"});
  const std::string box = "shape = \"box\"\npoint = [0, -1, 0]\n";
  expect_refused(box + "size = [1, 0, 1]\n", {"my.toml:12: obstacle.size", "> 0"});
  expect_refused(box + "size = [1, 1, 1]\nradius = 0.6\n", {"my.toml:13: obstacle.radius", "0.5"});
  expect_refused(box + "size = [1, 1, 1]\naxis = [1, 1, 0]\n",
                 {"my.toml:13: obstacle.axis", "right angles"});
  expect_refused(box + "size = [1, 1, 1]\ntouches = \"axis\"\n",
                 {"my.toml:13: obstacle.touches", "sharp", "radius"});
}

}  // namespace
}  // namespace dlo::compare
