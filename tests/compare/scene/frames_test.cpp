// Tests of clamps that hold the rod's frame: accepted and refused keys of a file.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "polygon/energy_problems.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

const std::string rod = R"([rod]
length = 0.5
diameter = "1 mm"
material = "spring_steel"
torsional_stiffness = "7.9e-3 N m^2"
)";
const std::string rod_without_torsion = rod.substr(0, rod.find("torsional"));

/// Returns a gripper of four lines with additional text. The first gripper after `rod` is on lines
/// 6 to 9, and its additional text begins on line 10.
std::string gripper(double at, const std::string& more, const std::string& hold = "clamp") {
  std::string text = "[[gripper]]\nat = " + std::to_string(at) + "\nposition = [" +
                     std::to_string(0.8 * at) + ", 0, 0]\nhold = \"" + hold + "\"\n";
  return text + more;
}

const std::string framed_clamp = gripper(0, "quaternion = [0.5, 0.5, 0.5, 0.5]\n");

Scene read(const std::string& text) { return parse_scene(text, "my.toml"); }

/// Returns the frame of the second of two clamps along x.
FrameHold frame_of(const std::string& keys) {
  const Scene scene = read(rod + framed_clamp + gripper(0.5, keys + "\n"));
  EXPECT_TRUE(scene.prescribes_twist());
  return scene.grippers.at(1).frame.value();
}

TEST(Frames, ARollIsAnAngleOfAnySize) {
  const FrameHold half = frame_of("direction = 0\nroll = \"180 deg\"");
  EXPECT_DOUBLE_EQ(half.roll, pi);
  EXPECT_FALSE(half.d1);
  EXPECT_EQ(frame_of("direction = 0\nroll = -25").roll, -25);
  EXPECT_DOUBLE_EQ(frame_of("direction = 0\nroll = \"1080 deg\"").roll, 6 * pi);
}

TEST(Frames, DirectorsAreRowsAndGiveTheDirection) {
  const std::string text =
      rod + framed_clamp + gripper(0.5, "frame = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]\n");
  const Gripper clamp = read(text).grippers.at(1);
  EXPECT_EQ(*clamp.direction, Vector3d::UnitY());
  EXPECT_EQ(*clamp.frame->d1, Vector3d::UnitZ());
  EXPECT_EQ(clamp.frame->roll, 0);
  const FrameHold turned = frame_of("frame = [[0, 0, 1], [0, -1, 0], [1, 0, 0]]\nturns = -2");
  EXPECT_DOUBLE_EQ(turned.roll, -4 * pi);
}

TEST(Frames, AQuaternionTurnsTheAxesIntoTheDirectors) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(0.3, -0.2, 0.7, 0.5).normalized();
  const std::string text =
      rod + framed_clamp +
      gripper(0.5, "quaternion = [" + std::to_string(q.w()) + ", " + std::to_string(q.x()) + ", " +
                       std::to_string(q.y()) + ", " + std::to_string(q.z()) + "]\nturns = 1\n");
  const Gripper clamp = read(text).grippers.at(1);  // its numbers have six decimals
  EXPECT_LT((*clamp.direction - q * Vector3d::UnitZ()).norm(), 3e-6);
  EXPECT_LT((*clamp.frame->d1 - q * Vector3d::UnitX()).norm(), 3e-6);
  EXPECT_NEAR(clamp.frame->d1->norm(), 1, 1e-15);
  EXPECT_NEAR(clamp.frame->d1->dot(*clamp.direction), 0, 1e-15);
  EXPECT_DOUBLE_EQ(clamp.frame->roll, 2 * pi);
}

TEST(Frames, ADirectionBesideDirectorsIsTheSame) {
  const FrameHold frame = frame_of(
      "direction = \"30 deg\"\nframe = [[0, 0, 1], [0.5, -0.866025, 0], [0.866025, 0.5, 0]]");
  EXPECT_LT((*frame.d1 - Vector3d::UnitZ()).norm(), 1e-15);
}

TEST(Frames, OneFrameAloneNeedsNothing) {
  const Scene scene = read(rod_without_torsion + gripper(0, "direction = 0\nroll = 1\n") +
                           gripper(0.5, "direction = 0\n"));
  EXPECT_FALSE(scene.prescribes_twist());
  EXPECT_FALSE(scene.torsional_stiffness);
  EXPECT_TRUE(scene.planar());
  EXPECT_EQ(energy_problem(scene).grips.at(0).frame->roll, 1);
}

struct BadFrame {
  std::string text;
  std::vector<std::string> named;  // texts that the message has to contain
};

TEST(Frames, ErrorsNameFileLineKeyAndWhatIsAllowed) {
  const std::string first = gripper(0, "direction = 0\nroll = 0\n");  // lines 6 to 11
  const std::string directors = "frame = [[0, 0, 1], [0, -1, 0], [1, 0, 0]]\n";
  const std::string plain = "direction = 0\n";
  const auto held = [](const std::string& more, const std::string& hold = "clamp") {
    return rod + gripper(0, more, hold);
  };
  const std::vector<BadFrame> cases = {
      {held(plain + "roll = inf\n"), {"my.toml:11", "gripper.roll", "finite"}},
      {held(plain + "roll = 0\nframe = 3\n"),
       {"my.toml:12", "gripper.frame", "besides roll", "one of the two"}},
      {held(directors + "quaternion = [1, 0, 0, 0]\n"),
       {"my.toml:11", "gripper.quaternion", "besides frame"}},
      {held(plain + "roll = 0\nturns = 1\n"),
       {"my.toml:12", "gripper.turns", "frame or quaternion", "720 deg"}},
      {held(directors + "turns = 1.5\n"),
       {"my.toml:11", "gripper.turns", "1.5", "whole number", "-1000 to 1000"}},
      {held("frame = [[0, 0, 1], [0, -1, 0], [1, 0]]\n"),
       {"my.toml:10", "gripper.frame", "three rows of three"}},
      {held("frame = [[0, 0, 1], [0, -1, 0], [1, 1e-5, 0]]\n"),
       {"my.toml:10", "gripper.frame", "1e-05", "up to 2e-06"}},
      {held("frame = [[0, 0, 1], [0, 1, 0], [1, 0, 0]]\n"),
       {"my.toml:10", "gripper.frame", "left-handed", "d3 = d1 x d2"}},
      {held("direction = 1\n" + directors),
       {"my.toml:10", "gripper.direction = 1", "d3 = [1, 0, 0] of the frame", "the same, or none"}},
      {held("quaternion = [1, 0, 0]\n"),
       {"my.toml:10", "gripper.quaternion", "four numbers [w, x, y, z]"}},
      {held("quaternion = [1, 1, 0, 0]\n"),
       {"my.toml:10", "gripper.quaternion", "norm 1.41421", "1 within"}},
      {held("roll = 1\n", "pin"), {"my.toml:10", "gripper.roll", "a pin holds neither"}},
      {held("turns = 1\n", "pin"), {"my.toml:10", "gripper.turns", "a pin"}},
      {rod_without_torsion + first + gripper(0.5, plain + "roll = 1\n"),
       {"my.toml:1: rod.torsional_stiffness: missing", "two clamps", "> 0", "0.00793 N m^2"}},
      {rod + first + gripper(0.5, "direction = \"180 deg\"\nroll = 1\n"),
       {"gripper.roll = 1", "opposite", "frame or quaternion"}},
      {rod + first + gripper(0.5, directors),
       {"my.toml:11: gripper.roll = 0", "a later clamp", "frame or quaternion"}},
  };
  for (const BadFrame& bad : cases) {
    const std::string text = error_of<InputError>([&] { return read(bad.text); });
    EXPECT_TRUE(has_all(text, bad.named));
    EXPECT_TRUE(has_none(text, {"\n"}));
  }
}

TEST(Frames, TheEnergyModelTakesWhatAFileMaySay) {
  const Scene scene = read(
      rod + gripper(0, "frame = [[0, 0, 1], [0, -1, 0], [1, 0, 0]]\nturns = 1\n") +
      gripper(0.2, "", "pin") + gripper(0.5, "quaternion = [0.5, 0.5, 0.5, 0.5]\nturns = 3\n"));
  const energy_model::Problem problem = energy_problem(scene);
  EXPECT_NO_THROW(energy_model::check(problem));
  EXPECT_EQ(problem.torsional_stiffness, 7.9e-3);
  EXPECT_EQ(*problem.grips.at(0).frame->d1, Vector3d::UnitZ());
  EXPECT_FALSE(problem.grips.at(1).frame);
  EXPECT_DOUBLE_EQ(problem.grips.at(2).frame->roll, 6 * pi);
}

TEST(Frames, HeldTwistIsInNoPlane) {
  Scene scene = test::heavy_scene(1, 0);
  scene.grippers.push_back({.at = 1, .position = {0.8, 0, 0}, .direction = Vector3d::UnitX()});
  EXPECT_TRUE(scene.planar());
  scene.grippers[0].frame = FrameHold{};
  EXPECT_TRUE(scene.planar());
  scene.grippers[1].frame = FrameHold{.d1 = std::nullopt, .roll = 1};
  EXPECT_FALSE(scene.planar());
}

}  // namespace
}  // namespace dlo::compare
