#include "dlo/compare/trajectory.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

std::vector<Pose> three_corners() {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  return {{0, {0, 0, 0}, x},
          {1, {0.3, 0.1, 0}, Eigen::Vector3d(1, 1, 0)},
          {1.5, {0.4, 0.4, 0.1}, Eigen::Vector3d(0, 1, 0)},
          {3, {0.1, 0.5, 0.2}, Eigen::Vector3d(0, 1, 1)}};
}

Eigen::Vector3d velocity(const Trajectory& way, double time, double step) {
  return (way.pose_at(time + step).position - way.pose_at(time).position) / step;
}

Eigen::Vector3d turning(const Trajectory& way, double time, double step) {
  return (*way.pose_at(time + step).direction - *way.pose_at(time).direction) / step;
}

TEST(Trajectory, MeetsItsPosesAndStandsBeforeAndAfterThem) {
  const Trajectory way(three_corners());
  for (const Pose& pose : way.poses()) {
    EXPECT_LT((way.pose_at(pose.time).position - pose.position).norm(), 1e-15);
    EXPECT_LT((*way.pose_at(pose.time).direction - *pose.direction).norm(), 1e-15);
  }
  EXPECT_EQ(way.pose_at(-5).position, way.poses().front().position);
  EXPECT_EQ(way.pose_at(7).position, way.poses().back().position);
  EXPECT_EQ(way.pose_at(7).direction, way.poses().back().direction);
}

// Velocities before and after a pose are compared, by differences whose error is of first order in
// the step.
TEST(Trajectory, HasContinuousRatesOfPositionAndDirection) {
  const Trajectory way(three_corners());
  constexpr double step = 1e-6;
  for (const double time : {0.0, 1.0, 1.5, 3.0}) {
    EXPECT_LT((velocity(way, time, step) - velocity(way, time, -step)).norm(), 1e-5) << time;
    EXPECT_LT((turning(way, time, step) - turning(way, time, -step)).norm(), 2e-5) << time;
  }
  EXPECT_GT(velocity(way, 1, step).norm(), 0.2);
  EXPECT_GT(turning(way, 1, step).norm(), 0.2);
  // At time 1.5 two great circles meet at an angle, where the angular velocity is zero.
  EXPECT_LT(turning(way, 1.5, step).norm(), 1e-5);
}

TEST(Trajectory, TurnsAlongTheGreatCircle) {
  const Trajectory way(three_corners());
  for (const double time : {0.2, 0.5, 0.9}) {
    const Eigen::Vector3d t = *way.pose_at(time).direction;
    EXPECT_NEAR(t.norm(), 1, 1e-15);
    EXPECT_NEAR(t.z(), 0, 1e-15);
  }
  const Eigen::Vector3d normal = Eigen::Vector3d(0, 1, 0).cross(Eigen::Vector3d(0, 1, 1));
  EXPECT_NEAR(way.pose_at(2).direction->dot(normal), 0, 1e-15);
}

// A pose that is given twice is held, and a motion along a line does not overshoot a pose.
TEST(Trajectory, NeitherLeavesAHeldPoseNorOvershoots) {
  const Trajectory way({{0, {0, 0, 0}, {}},
                        {1, {1, 0, 0}, {}},
                        {2, {1, 0, 0}, {}},
                        {2.1, {3, 0, 0}, {}},
                        {5, {3.1, 0, 0}, {}},
                        {6, {3, 0, 0}, {}}});
  double last = 0;
  for (int i = 0; i <= 500; ++i) {
    const double time = 0.01 * i;
    const Eigen::Vector3d at = way.pose_at(time).position;
    EXPECT_GE(at.x(), last - 1e-15) << time;
    EXPECT_EQ(at.y(), 0);
    EXPECT_TRUE(time < 1 || time > 2 || at.x() == 1) << time;
    last = at.x();
  }
  EXPECT_LE(last, 3.1);
}

TEST(Trajectory, RefusesWhatIsNoWay) {
  EXPECT_THROW(Trajectory(std::vector<Pose>{}), std::invalid_argument);
  EXPECT_THROW(Trajectory({{1, {0, 0, 0}, {}}, {1, {1, 0, 0}, {}}}), std::invalid_argument);
  EXPECT_THROW(Trajectory({{0, {0, 0, 0}, Eigen::Vector3d(1, 0, 0)}, {1, {1, 0, 0}, {}}}),
               std::invalid_argument);
  EXPECT_THROW(Trajectory({{0, {0, 0, 0}, Eigen::Vector3d(1, 0, 0)},
                           {1, {1, 0, 0}, Eigen::Vector3d(-2, 0, 0)}}),
               std::invalid_argument);
  EXPECT_THROW(Trajectory({{std::nan(""), {0, 0, 0}, {}}}), std::invalid_argument);
}

TEST(TrajectoryFile, HasItsColumnsInAnyOrder) {
  const Trajectory way = parse_trajectory(
      "\xEF\xBB\xBF# made by hand\nz,time,x,y,dz,dx,dy\n\n3,0,1,2,0,2,0\n3, 0.5 ,1.5,2,0,0,4\r\n",
      "my.csv");
  ASSERT_EQ(way.poses().size(), 2U);
  EXPECT_EQ(way.poses()[0].position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(*way.poses()[1].direction, Eigen::Vector3d::UnitY());
  EXPECT_EQ(way.end(), 0.5);
}

TEST(TrajectoryFile, IsRefusedWithLineValueAndWhatIsAllowed) {
  const auto error = [](const char* text) {
    return error_of<InputError>([&] { return parse_trajectory(text, "my.csv"); });
  };
  EXPECT_TRUE(has_all(error("time,x,y,w\n"), {"my.csv:1: unknown column \"w\" (allowed: "}));
  EXPECT_TRUE(has_all(error("time,x,y\n"), {"my.csv:1: column z is missing"}));
  EXPECT_TRUE(has_all(error("time,x,y,z,dx\n"), {"column dy is missing"}));
  EXPECT_TRUE(has_all(error("time,x,y,z\n0,1,2\n"), {"my.csv:2: 3 columns (allowed: 4"}));
  EXPECT_TRUE(has_all(error("time,x,y,z\n0,1,2,three\n"), {"my.csv:2: z = \"three\""}));
  EXPECT_TRUE(has_all(error("time,x,y,z\n0,1,2,3\n0,1,2,3\n"), {"my.csv:3: time = 0"}));
  EXPECT_TRUE(has_all(error("time,x,y,z\n"), {"no poses"}));
}

}  // namespace
}  // namespace dlo::compare
