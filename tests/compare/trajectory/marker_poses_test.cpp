// Tests of grippers whose poses follow from two markers with different times.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene_file.hpp"
#include "folder_fixture.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

constexpr double radius = 0.2;  // [m]
constexpr double rate = 2;      // [rad/s]

/// Returns the direction of a gripper that moves on a helix about z and rotates with it: the
/// tangent of the helix's circle.
Eigen::Vector3d direction_at(double time) {
  return {-std::sin(rate * time), std::cos(rate * time), 0};
}
Eigen::Vector3d position_at(double time) {
  return {radius * std::cos(rate * time), radius * std::sin(rate * time), 0.1 * time};
}

/// Adds a marker that is observed every `step` from `begin` to 2 s; `at` is the arc length at which
/// the gripper holds the rod.
void add_marker(MarkerMotion& motion, double s, double at, double begin, double step) {
  for (double time = begin; time <= 2; time += step) {
    motion.positions.push_back({time, s, position_at(time) + (s - at) * direction_at(time)});
  }
}

TEST(MarkerPoses, OfMarkersSeenTogetherAreThoseOfTheGripper) {
  for (const double at : {0.0, 1.0}) {
    MarkerMotion motion{.file = "g.csv", .positions = {}};
    add_marker(motion, at + 0.03, at, 0, 0.1);
    add_marker(motion, at - 0.02, at, 0, 0.1);
    const std::vector<Pose> poses = poses_of_markers(motion, at, std::nullopt);
    ASSERT_GE(poses.size(), 20U);
    for (const Pose& pose : poses) {
      EXPECT_LT((pose.position - position_at(pose.time)).norm(), 1e-15);
      EXPECT_LT((*pose.direction - direction_at(pose.time)).norm(), 1e-13);
      EXPECT_FALSE(pose.roll);
    }
  }
}

// Between its rows a marker is on a cubic whose end velocities are those of parabolas: they are off
// by up to h^2 f'''/6, the cubic by 8/27 h of that and h^4/384 f''''.
TEST(MarkerPoses, OfRatesThatDifferAreAtTheTimesOfTheFasterMarker) {
  constexpr double step = 1.0 / 30;
  constexpr double ahead = 0.03;
  MarkerMotion motion{.file = "g.csv", .positions = {}};
  add_marker(motion, 0, 0, 0, 0.01);
  add_marker(motion, ahead, 0, 0.014, step);
  const std::vector<Pose> poses = poses_of_markers(motion, 0, std::nullopt);
  EXPECT_NEAR(poses.front().time, 0.02, 1e-12);
  EXPECT_NEAR(poses[1].time - poses[0].time, 0.01, 1e-12);
  const double reach = std::hypot(radius, ahead);
  const double error =
      std::pow(step * rate, 3) * reach / 6 * 8 / 27 + std::pow(step * rate, 4) * reach / 384;
  for (const Pose& pose : poses) {
    // A trajectory begins and ends at rest, so its ends are excluded.
    if (pose.time < 0.1 || pose.time > 1.9) continue;
    EXPECT_LT((*pose.direction - direction_at(pose.time)).norm(), 2 * error / ahead);
    EXPECT_LT((pose.position - position_at(pose.time)).norm(), 2 * error);
  }
}

TEST(MarkerPoses, ShareWhatTheMarkersAreOffAlongTheLine) {
  const MarkerMotion motion{.file = "g.csv",
                            .positions = {{0, 0, {-0.002, 0, 0}}, {0, 0.05, {0.052, 0, 0}}}};
  const std::vector<Pose> poses = poses_of_markers(motion, 0.01, std::nullopt);
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_NEAR((poses[0].position - Eigen::Vector3d(0.01, 0, 0)).norm(), 0, 1e-15);
}

// Errors that alternate, at half the sampling rate, are damped by 1 + (sqrt(2) - 1) / sin^4(pi f_c
// h).
TEST(MarkerPoses, AreSmoothedMarkerByMarker) {
  constexpr double error = 1e-3;
  constexpr double cutoff = 5;
  MarkerMotion motion{.file = "g.csv", .positions = {}};
  const auto add = [&](double s, double step) {
    for (int i = 0; i * step <= 2; ++i) {
      motion.positions.push_back({i * step, s, {s, i % 2 == 0 ? error : -error, 0}});
    }
  };
  add(0, 0.01);
  add(0.1, 0.02);
  const double sine = std::sin(std::numbers::pi * cutoff * 0.02);  // of the slower, less damped one
  const double left = error / (1 + (std::numbers::sqrt2 - 1) / std::pow(sine, 4));
  for (const Pose& pose : poses_of_markers(motion, 0, cutoff)) {
    if (pose.time < 0.5 || pose.time > 1.5) continue;
    EXPECT_LT(std::abs(pose.position.y()), 1.01 * left);
    EXPECT_LT(std::abs(pose.direction->y()), 1.01 * 2 * left / 0.1);
  }
}

TEST(MarkerPoses, RefuseWhatIsNoPair) {
  const auto refusal = [](std::vector<MarkerPosition> positions) {
    return error_of<InputError>([&] {
      return poses_of_markers({.file = "g.csv", .positions = std::move(positions)}, 0,
                              std::nullopt);
    });
  };
  EXPECT_TRUE(has_all(refusal({{0, 0, {0, 0, 0}}}), {"g.csv: 1 marker, by", "(allowed: two"}));
  EXPECT_TRUE(has_all(refusal({{0, 0, {0, 0, 0}}, {0, 1, {1, 0, 0}}, {0, 2, {2, 0, 0}}}),
                      {"g.csv: 3 markers"}));
  EXPECT_TRUE(has_all(refusal({{0, 0, {0, 0, 0}}, {1, 1, {1, 0, 0}}}),
                      {"s = 0 and 1 m are not seen at the same time"}));
  EXPECT_TRUE(has_all(refusal({{0, 0, {0, 0, 0}}, {0, 0.05, {50, 0, 0}}}),
                      {"s = 0 and 0.05 m are 50 m apart", "allowed: 0.04 to 0.06 m"}));
}

class MarkerPosesFile : public test::Folder {
 protected:
  [[nodiscard]] std::string scene(const std::string& gripper) const {
    return write("scene.toml",
                 "[rod]\nlength = 1\nbending_stiffness = 1e-3\nmass_per_length = 0.01\n"
                 "[[gripper]]\nat = 1\ntrajectory = \"g.csv\"\n" +
                     gripper);
  }
  void write_markers(const char* last) const {
    write("g.csv", std::string("time,s,x,y,z\n0,0.9,0,0.9,0\n0,1,0,1,0\n1,1,1,1,0\n1,0.9,1,0.9,0\n"
                               "2,1,2,1,0\n2,0.9,") +
                       last);
  }
  void expect_refused(const std::string& gripper, const std::vector<std::string>& pieces) const {
    const std::string message =
        error_of<InputError>([&] { return load_scene(scene(gripper), {}); });
    EXPECT_TRUE(has_all(message, pieces));
    EXPECT_TRUE(has_none(message, {"\n"}));
  }
};

TEST_F(MarkerPosesFile, IsTheTrajectoryOfAGripper) {
  write_markers("2,0.9,0\n");
  const Scene held = load_scene(scene(""), {});
  const Gripper& gripper = held.grippers.front();
  EXPECT_EQ(gripper.trajectory.poses().size(), 3U);
  EXPECT_LT((gripper.position - Eigen::Vector3d(0, 1, 0)).norm(), 1e-15);
  EXPECT_LT((*gripper.direction - Eigen::Vector3d::UnitY()).norm(), 1e-15);
}

TEST_F(MarkerPosesFile, IsRefusedWithKeyAndFile) {
  write_markers("2,0.4,0\n");
  expect_refused("cutoff = \"10 Hz\"\n", {"scene.toml:", "gripper.cutoff", "below"});
  write_markers("2,two,0\n");
  expect_refused("", {"scene.toml:", "gripper.trajectory", "g.csv:7: y = \"two\" is not a number"});
  write_markers("2,1.1,0\n");
  expect_refused("", {"gripper.trajectory", "opposite"});
  write_markers("2,0.9,0\n");
  expect_refused("hold = \"pin\"\n", {"has directions (allowed here: time,x,y,z)"});
}

}  // namespace
}  // namespace dlo::compare
