// Tests of scenes whose grippers and obstacles move: accepted and refused keys of a file.

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene_file.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

const std::string held_rod =
    "[rod]\nlength = 1\ndiameter = 0.02\nmaterial = \"silicone\"\n[[gripper]]\nat = 0\n";
const std::string two_poses =
    "[[gripper.pose]]\ntime = 1\nposition = [0, 0, 0]\ndirection = \"0 deg\"\n"
    "[[gripper.pose]]\ntime = \"3000 ms\"\nposition = [\"20 cm\", 0, 0]\n"
    "direction = \"90 deg\"\n";

TEST(MovingScene, IsAtItsFirstPoseUnlessATimeIsAskedFor) {
  const Scene scene = parse_scene(held_rod + two_poses, "my.toml");
  EXPECT_EQ(scene.grippers[0].position, Eigen::Vector3d::Zero());
  EXPECT_EQ(motion_time_span(scene)->begin, 1);
  EXPECT_EQ(motion_time_span(scene)->end, 3);
  const Scene half = scene_at(scene, 2);
  EXPECT_LT((half.grippers[0].position - Eigen::Vector3d(0.1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((*half.grippers[0].direction - Eigen::Vector3d(1, 1, 0).normalized()).norm(), 1e-15);
  EXPECT_FALSE(motion_time_span(half));
  EXPECT_EQ(half.length, scene.length);
}

TEST(MovingScene, MovesObstaclesByTheirOwnTime) {
  const Scene scene = parse_scene(
      held_rod + two_poses + "[[obstacle]]\nnormal = [0, 1, 0]\n[[obstacle.pose]]\ntime = 0\n" +
          "point = [0, -1, 0]\n[[obstacle.pose]]\ntime = 2\npoint = [0, -0.5, 0]\n",
      "my.toml");
  const auto height = [&](double time, double obstacle_time) {
    return scene_at(scene, time, obstacle_time).obstacles[0].body.clearance({0, 0, 0});
  };
  EXPECT_NEAR(height(2, 0), 0.99, 1e-15);
  EXPECT_NEAR(height(0, 1), 0.74, 1e-15);
  EXPECT_NEAR(scene.obstacles[0].body.clearance({0, 0, 0}), 0.99, 1e-15);
}

TEST(MovingScene, KeepsADirectionThatNoPoseHas) {
  const Scene scene = parse_scene(
      held_rod + "direction = [0, 1, 0]\n[[gripper.pose]]\ntime = 0\nposition = [0, 0, 0]\n",
      "my.toml");
  EXPECT_EQ(*scene_at(scene, 5).grippers[0].direction, Eigen::Vector3d::UnitY());
}

TEST(MovingScene, ReadsPosesFromAFileBesideIt) {
  const std::string folder = testing::TempDir();
  std::ofstream(folder + "way.csv") << "time,x,y,z\n0,0,0,0\n1,0.5,0,0\n";
  const std::string text = held_rod + "hold = \"pin\"\ntrajectory = \"way.csv\"\n";
  const Scene scene = parse_scene(text, folder + "my.toml");
  EXPECT_EQ(scene_at(scene, 1).grippers[0].position.x(), 0.5);
  std::ofstream(folder + "way.csv") << "time,x,y,z\n0,0,0,nowhere\n";
  EXPECT_TRUE(has_all(error_of<InputError>([&] { return parse_scene(text, folder + "my.toml"); }),
                      {"my.toml:8: gripper.trajectory = 'way.csv': way.csv:2: "
                       "z = \"nowhere\""}));
  // The scene's name may begin the name of the other file.
  const std::string absolute = replaced(text, "way.csv", folder + "way.csv");
  EXPECT_TRUE(has_all(error_of<InputError>([&] { return parse_scene(absolute, folder + "way"); }),
                      {"way:8: gripper.trajectory"}));
}

TEST(MovingScene, SaysWhatIsWrongWithAPose) {
  const auto expect_error = [](const std::string& text, const std::string& part) {
    EXPECT_TRUE(has_all(scene_error(text), {part}));
  };
  const std::string first = "[[gripper.pose]]\ntime = 0\nposition = [0, 0, 0]\n";
  expect_error(held_rod + "position = [0, 0, 0]\n" + two_poses,
               "my.toml:7: gripper.position = [ 0, 0, 0 ]: given besides pose");
  expect_error(held_rod + first, "gripper.direction: missing");
  expect_error(held_rod + two_poses + first,
               "gripper.pose.time = 0: not above that of the pose before");
  expect_error(held_rod + two_poses + "[[gripper.pose]]\ntime = 4\nposition = [0, 0, 0]\n",
               "given for some poses only");
  expect_error(held_rod + two_poses + "[[gripper.pose]]\ntime = \"4 h\"\nposition = [0, 0, 0]\n",
               "unknown unit \"h\" in \"4 h\" (allowed: s, ms, min)");
  const std::string rolls = first + "direction = \"0 deg\"\nroll = 1\n";
  expect_error(held_rod + rolls + "[[gripper.pose]]\ntime = 1\nposition = [0, 0, 0]\n" +
                   "direction = \"0 deg\"\n",
               "gripper.pose.roll: given for some poses only");
  expect_error(held_rod + "roll = 1\n" + rolls, "gripper.roll = 1: given besides poses with rolls");
  expect_error(held_rod + "trajectory = \"none.csv\"\n", "no such file beside the scene");
  expect_error(held_rod + "trajectory = \"none.csv\"\n" + two_poses, "given besides pose");
  expect_error(held_rod + two_poses + "[track]\nframe_rate = 0\n",
               "track.frame_rate = 0: out of range");
}

}  // namespace
}  // namespace dlo::compare
