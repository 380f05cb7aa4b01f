#include "dlo/compare/trajectory.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

/// Tolerance within which directions count as opposite, so that no great circle between them is
/// defined [-].
constexpr double opposite_tolerance = 1e-9;

void require(bool holds, std::size_t pose, const char* what) {
  if (holds) return;
  throw std::invalid_argument(fmt::format("Trajectory: pose {}: {}", pose + 1, what));
}

}  // namespace

Trajectory::Trajectory(std::vector<Pose> poses) : poses_(std::move(poses)) {
  require(!poses_.empty(), 0, "missing (allowed: one or more)");
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    Pose& pose = poses_[i];
    require(std::isfinite(pose.time) && pose.position.allFinite(), i, "not finite");
    require(pose.direction.has_value() == poses_.front().direction.has_value(), i,
            "direction given for some poses only (allowed: for all or none)");
    require(pose.roll.has_value() == poses_.front().roll.has_value(), i,
            "roll given for some poses only (allowed: for all or none)");
    require(std::isfinite(pose.roll.value_or(0)), i, "roll is not finite");
    if (pose.direction) {
      require(pose.direction->norm() > 0 && pose.direction->allFinite(), i,
              "direction of no length");
      pose.direction->normalize();
    }
    if (i == 0) continue;
    const Pose& last = poses_[i - 1];
    require(pose.time > last.time, i, "time is not above that of the pose before");
    require(!pose.direction || (*pose.direction + *last.direction).norm() > opposite_tolerance, i,
            "direction is opposite to that of the pose before, so that the rotation is "
            "undetermined (allowed: a pose between them)");
  }
}

Pose Trajectory::pose_at(double time) const {
  const auto standing = [time](Pose pose) {
    pose.time = time;
    return pose;
  };
  if (!(time > begin())) return standing(poses_.front());
  if (!(time < end())) return standing(poses_.back());
  const auto next = std::upper_bound(poses_.begin(), poses_.end(), time,
                                     [](double t, const Pose& pose) { return t < pose.time; });
  const auto last = static_cast<std::size_t>(next - poses_.begin()) - 1;
  const TrajectoryLeg leg = leg_after(poses_, last);
  Pose pose{time, leg.position(time), leg.from.direction, std::nullopt};
  if (leg.from.roll) pose.roll = leg.rolled(time);
  if (!(leg.angle > 0)) return pose;
  pose.direction =
      (Eigen::AngleAxisd(leg.turned(time), leg.axis) * *leg.from.direction).normalized();
  return pose;
}

}  // namespace dlo::compare
