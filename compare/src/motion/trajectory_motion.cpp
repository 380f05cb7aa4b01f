#include "motion/trajectory_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

/// Relative rounding of times, as the integrator's own units cause it [-]. The integrator requests
/// values after a pose at 1e-12 beyond it.
constexpr double time_rounding = 1e-14;

/// A leg of a trajectory, and the rotation of its directions at its start.
struct TurnedLeg {
  TrajectoryLeg leg;
  Eigen::Quaterniond first_turn;
};

/// Direction and roll of a rolling clamp at time zero.
struct Rolling {
  Eigen::Vector3d direction;
  double roll;
};

/// Returns the legs of a trajectory, with time zero at `begin`.
std::vector<TurnedLeg> turned_legs(const Trajectory& way, double begin) {
  std::vector<Pose> poses = way.poses();
  for (Pose& pose : poses) pose.time -= begin;
  std::vector<TurnedLeg> result;
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const TrajectoryLeg leg = leg_after(poses, i);
    result.push_back({leg, turn});
    turn = Eigen::Quaterniond(Eigen::AngleAxisd(leg.angle, leg.axis)) * turn;
  }
  return result;
}

energy_model::GripPose pose_on(const TurnedLeg& turned, const std::optional<Rolling>& first,
                               double time) {
  const TrajectoryLeg& leg = turned.leg;
  energy_model::GripPose pose;
  pose.position = leg.position(time);
  pose.velocity = leg.position(time, 1);
  pose.acceleration = leg.position(time, 2);
  pose.turn = Eigen::Quaterniond(Eigen::AngleAxisd(leg.turned(time), leg.axis)) * turned.first_turn;
  pose.angular_velocity = leg.turned(time, 1) * leg.axis;
  pose.angular_acceleration = leg.turned(time, 2) * leg.axis;
  if (!first) return pose;
  const Eigen::Vector3d about = (pose.turn * first->direction).normalized();
  const double rate = leg.rolled(time, 1);
  pose.turn = Eigen::AngleAxisd(leg.rolled(time) - first->roll, about) * pose.turn;
  pose.angular_acceleration +=
      leg.rolled(time, 2) * about + rate * pose.angular_velocity.cross(about);
  pose.angular_velocity += rate * about;
  return pose;
}

/// Returns a pose without velocities and accelerations.
energy_model::GripPose standing_at(const energy_model::GripPose& end) {
  energy_model::GripPose pose;
  pose.position = end.position;
  pose.turn = end.turn;
  return pose;
}

energy_model::GripPose pose_among(const std::vector<TurnedLeg>& legs,
                                  const std::optional<Rolling>& first, double time) {
  const double earlier = time - time_rounding * std::abs(time);
  const auto leg =
      std::lower_bound(legs.begin(), legs.end(), earlier,
                       [](const TurnedLeg& turned, double t) { return turned.leg.to.time < t; });
  if (leg == legs.end()) return standing_at(pose_on(legs.back(), first, legs.back().leg.to.time));
  if (!(earlier > leg->leg.from.time)) {
    return standing_at(pose_on(legs.front(), first, legs.front().leg.from.time));
  }
  return pose_on(*leg, first, time);
}

}  // namespace

energy_model::GripMotion trajectory_motion(const Trajectory& way, double begin,
                                           const std::optional<Eigen::Vector3d>& rolls_about) {
  if (way.poses().size() == 1) return energy_model::standing(way.poses().front().position);
  std::vector<TurnedLeg> legs = turned_legs(way, begin);
  const Eigen::Quaterniond before = pose_among(legs, std::nullopt, 0).turn;
  for (TurnedLeg& turned : legs) turned.first_turn *= before.conjugate();
  std::optional<Rolling> first;
  const std::optional<double> roll = way.pose_at(begin).roll;
  if (roll && rolls_about) first = Rolling{*rolls_about, *roll};
  return [legs = std::move(legs), first](double time) { return pose_among(legs, first, time); };
}

std::vector<double> trajectory_breaks(const Trajectory& way, double begin) {
  std::vector<double> result;
  for (const Pose& pose : way.poses()) result.push_back(pose.time - begin);
  return result;
}

}  // namespace dlo::compare
