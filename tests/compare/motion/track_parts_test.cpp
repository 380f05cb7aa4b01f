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

// For any part of the motion, and for any ratio of the frame rates.
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
      TrackRates rates;
      rates.frames = frames;
      rates.obstacles = 1 / every;
      const FrameClock clock(scene, {begin, 0.5}, rates);
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

TEST(Lag, IsTheShiftOfASeriesOfShapes) {
  std::vector<Eigen::Matrix3Xd> leader;
  std::vector<Eigen::Matrix3Xd> follower;
  constexpr double step = 0.01;
  const auto shape_at = [](double time) {
    const double way = time <= 0 ? 0 : time * time * (3 - 2 * time);
    Eigen::Matrix3Xd shape(3, 2);
    shape << 0, 1, way, way * way, 0, 0;
    return shape;
  };
  for (int i = 0; i <= 100; ++i) {
    leader.push_back(shape_at(step * i));
    follower.push_back(shape_at(step * (i - 7.3)));
  }
  EXPECT_NEAR(lag_of(leader, follower, step).time, 0.073, 1e-3 * 0.073 + 1e-4);
  EXPECT_LT(lag_of(leader, follower, step).rms, 5e-3);
  EXPECT_NEAR(lag_of(leader, leader, step).time, 0, 1e-12);
  const std::vector<Eigen::Matrix3Xd> stands(10, shape_at(0));
  EXPECT_TRUE(std::isnan(lag_of(stands, stands, step).time));
  // A motion in the opposite direction has no lag.
  std::vector<Eigen::Matrix3Xd> away;
  for (int i = 0; i <= 100; ++i) {
    away.push_back(shape_at(step * i));
    away.back().row(1) *= -1;
  }
  EXPECT_TRUE(std::isnan(lag_of(leader, away, step).time));
}

ContactPart part(std::size_t obstacle, ContactKind kind, double begin, double end) {
  return {.obstacle = obstacle, .kind = kind, .begin = begin, .end = end};
}

TEST(ContactChanges, PairTheNearestPartsOfAnObstacle) {
  const std::vector<ContactPart> three = {part(0, ContactKind::touching, 0.2, 0.2),
                                          part(0, ContactKind::lying, 0.6, 0.8),
                                          part(1, ContactKind::tip, 1, 1)};
  const std::vector<ContactPart> two = {part(0, ContactKind::lying, 0.58, 0.83),
                                        part(1, ContactKind::tip, 1, 1)};
  EXPECT_TRUE(contact_changes(three, three).empty());
  const std::vector<ContactChange> gone = contact_changes(three, two);
  ASSERT_EQ(gone.size(), 1U);
  EXPECT_FALSE(gone[0].begins);
  EXPECT_FALSE(gone[0].goes_on);
  EXPECT_EQ(gone[0].part.begin, 0.2);
  const std::vector<ContactChange> come = contact_changes(two, three);
  ASSERT_EQ(come.size(), 1U);
  EXPECT_TRUE(come[0].begins);
  EXPECT_EQ(come[0].part.begin, 0.2);
}

TEST(ContactChanges, TellWhereAPointBeginsToLie) {
  const std::vector<ContactPart> point = {part(2, ContactKind::touching, 0.5, 0.5)};
  const std::vector<ContactPart> line = {part(2, ContactKind::lying, 0.45, 0.55)};
  const std::vector<ContactChange> lies = contact_changes(point, line);
  ASSERT_EQ(lies.size(), 1U);
  EXPECT_TRUE(lies[0].begins && lies[0].goes_on);
  EXPECT_EQ(lies[0].part.kind, ContactKind::lying);
  const std::vector<ContactChange> lifts = contact_changes(line, point);
  ASSERT_EQ(lifts.size(), 1U);
  EXPECT_TRUE(!lifts[0].begins && lifts[0].goes_on);
  EXPECT_EQ(lifts[0].part.kind, ContactKind::lying);
}

}  // namespace
}  // namespace dlo::compare
