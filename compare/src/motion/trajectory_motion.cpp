#include "motion/trajectory_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "trajectory/trajectory_leg.hpp"

namespace dlo::compare {
namespace {

/// By which a time may be off the pose that is meant, as the integrator's own units make it; it
/// asks for what is after a pose at 1e-12 beyond [-].
constexpr double time_rounding = 1e-14;

/// A leg, and the turn that its directions begin with.
struct TurnedLeg {
  TrajectoryLeg leg;
  Eigen::Quaterniond first_turn;
  /// At the begin of all legs, where rolls count.
  std::optional<Eigen::Vector3d> first_direction;
  double first_roll = 0;
};

/// With zero time at `begin`.
std::vector<TurnedLeg> turned_legs(const Trajectory& way, double begin,
                                   const std::optional<Eigen::Vector3d>& rolls_about) {
  std::vector<Pose> poses = way.poses();
  for (Pose& pose : poses) pose.time -= begin;
  std::vector<TurnedLeg> result;
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const TrajectoryLeg leg = leg_after(poses, i);
    result.push_back({leg, turn, rolls_about, poses.front().roll.value_or(0)});
    turn = Eigen::Quaterniond(Eigen::AngleAxisd(leg.angle, leg.axis)) * turn;
  }
  return result;
}

energy_model::GripPose pose_on(const TurnedLeg& turned, double time) {
  const TrajectoryLeg& leg = turned.leg;
  energy_model::GripPose pose;
  pose.position = leg.position(time);
  pose.velocity = leg.position(time, 1);
  pose.acceleration = leg.position(time, 2);
  pose.turn = Eigen::Quaterniond(Eigen::AngleAxisd(leg.turned(time), leg.axis)) * turned.first_turn;
  pose.angular_velocity = leg.turned(time, 1) * leg.axis;
  pose.angular_acceleration = leg.turned(time, 2) * leg.axis;
  if (!leg.from.roll || !turned.first_direction) return pose;
  const Eigen::Vector3d about = (pose.turn * *turned.first_direction).normalized();
  const double rate = leg.rolled(time, 1);
  pose.turn = Eigen::AngleAxisd(leg.rolled(time) - turned.first_roll, about) * pose.turn;
  pose.angular_acceleration +=
      leg.rolled(time, 2) * about + rate * pose.angular_velocity.cross(about);
  pose.angular_velocity += rate * about;
  return pose;
}

/// At rest.
energy_model::GripPose standing_at(const energy_model::GripPose& end) {
  energy_model::GripPose pose;
  pose.position = end.position;
  pose.turn = end.turn;
  return pose;
}

}  // namespace

energy_model::GripMotion trajectory_motion(const Trajectory& way, double begin,
                                           const std::optional<Eigen::Vector3d>& rolls_about) {
  if (way.poses().size() == 1) return energy_model::standing(way.poses().front().position);
  return [legs = turned_legs(way, begin, rolls_about)](double time) {
    const double earlier = time - time_rounding * std::abs(time);
    const auto leg =
        std::lower_bound(legs.begin(), legs.end(), earlier,
                         [](const TurnedLeg& turned, double t) { return turned.leg.to.time < t; });
    if (leg == legs.end()) return standing_at(pose_on(legs.back(), legs.back().leg.to.time));
    if (!(earlier > leg->leg.from.time)) {
      return standing_at(pose_on(legs.front(), legs.front().leg.from.time));
    }
    return pose_on(*leg, time);
  };
}

std::vector<double> trajectory_breaks(const Trajectory& way, double begin) {
  std::vector<double> result;
  for (const Pose& pose : way.poses()) result.push_back(pose.time - begin);
  return result;
}

}  // namespace dlo::compare
