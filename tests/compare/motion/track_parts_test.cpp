// Tests of the parts of a track: times of its frames, lag of a series, changes of contacts.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "dlo/compare/scene_file.hpp"
#include "motion/frame_clock.hpp"
#include "motion/track.hpp"

namespace dlo::compare {
namespace {

using energy_model::ContactKind;
using energy_model::ContactPart;

// In each frame an obstacle has its position of the last tick of the obstacle rate, for any part of
// the motion and any ratio of the rates.
TEST(FrameClock, ObstaclesAreWhereTheirOwnFrameBeforeHasThem) {
  const Scene scene = parse_scene(
      "[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 0.5\n[[gripper]]\nat = 0\n"
      "position = [0, 0, 0]\ndirection = \"0 deg\"\n[[obstacle]]\nnormal = [0, 1, 0]\n"
      "touches = \"axis\"\n[[obstacle.pose]]\ntime = 0\npoint = [0, -0.7, 0]\n"
      "[[obstacle.pose]]\ntime = 1\npoint = [0, -0.2, 0]\n",
      "floor.toml");
  constexpr double every = 0.04;
  for (const double begin : {0.0, 0.13}) {
    for (const double frames : {100.0, 60.0}) {
      const FrameClock clock(scene, {begin, 0.5},
                             {.frame_rate = frames, .obstacle_rate = 1 / every});
      double last = begin;
      for (std::size_t frame = 0; frame < clock.frames(); ++frame) {
        const double time = clock.time(frame);
        const double moved = clock.obstacle_time(frame);
        EXPECT_LE(moved, time + 1e-9);
        EXPECT_GT(moved, time - every - 1e-9);
        const double ticks = (moved - begin) / every;
        EXPECT_NEAR(ticks, std::round(ticks), 1e-9);
        const Eigen::Vector3d there(0.3, 0.4, 0);
        EXPECT_NEAR(clock.scene(scene, frame).obstacles[0].body.clearance(there),
                    scene_at(scene, moved).obstacles[0].body.clearance(there), 1e-12);
        EXPECT_GE(moved, last);
        last = moved;
      }
      EXPECT_GT(last, 0.4);
    }
  }
}

TEST(Lag, OfWhatStandsOrMovesTheOtherWayThereIsNone) {
  std::vector<Eigen::Matrix3Xd> leader;
  constexpr double step = 0.01;
  for (int i = 0; i <= 100; ++i) {
    const double way = step * i;
    leader.push_back((Eigen::Matrix3Xd(3, 2) << 0, 1, way, way * way, 0, 0).finished());
  }
  const std::vector<Eigen::Matrix3Xd> stands(10, leader.front());
  EXPECT_TRUE(std::isnan(estimate_lag(stands, stands, step).time));
  std::vector<Eigen::Matrix3Xd> away = leader;
  for (Eigen::Matrix3Xd& shape : away) shape.row(1) *= -1;
  EXPECT_TRUE(std::isnan(estimate_lag(leader, away, step).time));
}

TEST(ContactChanges, PairTheNearestPartsOfAnObstacle) {
  const ContactPart point{.kind = ContactKind::touching, .begin = 0.2, .end = 0.2};
  const ContactPart line{.kind = ContactKind::lying, .begin = 0.6, .end = 0.8};
  const ContactPart moved{.kind = ContactKind::lying, .begin = 0.58, .end = 0.83};
  EXPECT_TRUE(contact_changes({point, line}, {point, line}).empty());
  for (const bool begins : {false, true}) {
    const std::vector<ContactPart> both = {point, line};
    const std::vector<ContactChange> changes =
        begins ? contact_changes({moved}, both) : contact_changes(both, {moved});
    ASSERT_EQ(changes.size(), 1U);
    EXPECT_EQ(changes[0].begins, begins);
    EXPECT_FALSE(changes[0].contact_persists);
    EXPECT_EQ(changes[0].part.begin, 0.2);
  }
}

}  // namespace
}  // namespace dlo::compare
