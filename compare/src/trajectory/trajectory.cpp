#include "dlo/compare/trajectory.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace dlo::compare {
namespace {

/// Great circles whose tangents differ by less go on as one [-].
constexpr double same_circle = 1e-6;
/// Directions within this of opposite have no great circle between them [-].
constexpr double opposite = 1e-9;

/// Weights of Hermite's cubic at a share of the time between two poses.
struct Hermite {
  double from, to;              ///< of the values
  double slope_from, slope_to;  ///< of the rates, per time between
};

Hermite hermite(double u) {
  const double v = 1 - u;
  return {v * v * (1 + 2 * u), u * u * (1 + 2 * v), u * v * v, -u * u * v};
}

/// No faster than three times the slower side.
double speed_share(double speed, double before, double after) {
  const double most = 3 * std::min(before, after);
  return speed > most ? most / speed : 1;
}

/// The great circle from one direction to the next.
struct GreatCircle {
  double angle = 0;                                ///< [rad]
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();  ///< unit; zero where the two are the same
};

GreatCircle circle_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d across = from.cross(to);
  const double sine = across.norm();
  if (!(sine > 0)) return {};
  return {std::atan2(sine, from.dot(to)), across / sine};
}

/// Rate of turning at a pose between two great circles [rad/s].
double turning_rate(const GreatCircle& before, const GreatCircle& after, double h_before,
                    double h_after) {
  if (!((before.axis - after.axis).norm() < same_circle)) return 0;
  const double s_before = before.angle / h_before;
  const double s_after = after.angle / h_after;
  const double rate = (h_after * s_before + h_before * s_after) / (h_before + h_after);
  return rate * speed_share(rate, s_before, s_after);
}

Eigen::Vector3d velocity_between(const Pose& a, const Pose& b, const Pose& c) {
  const double h_before = b.time - a.time;
  const double h_after = c.time - b.time;
  const Eigen::Vector3d before = (b.position - a.position) / h_before;
  const Eigen::Vector3d after = (c.position - b.position) / h_after;
  if (!(before.dot(after) > 0)) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d v = (h_after * before + h_before * after) / (h_before + h_after);
  return v * speed_share(v.norm(), before.norm(), after.norm());
}

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
    if (pose.direction) {
      require(pose.direction->norm() > 0 && pose.direction->allFinite(), i,
              "direction of no length");
      pose.direction->normalize();
    }
    if (i == 0) continue;
    const Pose& last = poses_[i - 1];
    require(pose.time > last.time, i, "time is not above that of the pose before");
    require(!pose.direction || (*pose.direction + *last.direction).norm() > opposite, i,
            "direction is opposite to that of the pose before, which leaves the way to turn open "
            "(allowed: a pose between them)");
  }
}

Pose Trajectory::pose_at(double time) const {
  if (!(time > begin())) return {time, poses_.front().position, poses_.front().direction};
  if (!(time < end())) return {time, poses_.back().position, poses_.back().direction};
  const auto next = std::upper_bound(poses_.begin(), poses_.end(), time,
                                     [](double t, const Pose& pose) { return t < pose.time; });
  const auto last = static_cast<std::size_t>(next - poses_.begin()) - 1;
  const Pose& a = poses_[last];
  const Pose& b = poses_[last + 1];
  const bool first = last == 0;
  const bool final = last + 2 == poses_.size();
  const double h = b.time - a.time;
  const Hermite at = hermite((time - a.time) / h);
  const Eigen::Vector3d v_a =
      first ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : velocity_between(poses_[last - 1], a, b);
  const Eigen::Vector3d v_b =
      final ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : velocity_between(a, b, poses_[last + 2]);
  Pose pose{time,
            a.position + at.to * (b.position - a.position) + h * at.slope_from * v_a +
                h * at.slope_to * v_b,
            a.direction};
  if (!a.direction) return pose;
  const GreatCircle circle = circle_between(*a.direction, *b.direction);
  if (!(circle.angle > 0)) return pose;
  const auto circle_of = [this](std::size_t i) {
    return circle_between(*poses_[i].direction, *poses_[i + 1].direction);
  };
  const double rate_a =
      first ? 0 : turning_rate(circle_of(last - 1), circle, a.time - poses_[last - 1].time, h);
  const double rate_b =
      final ? 0 : turning_rate(circle, circle_of(last + 1), h, poses_[last + 2].time - b.time);
  const double angle = at.to * circle.angle + h * (at.slope_from * rate_a + at.slope_to * rate_b);
  pose.direction = (Eigen::AngleAxisd(angle, circle.axis) * *a.direction).normalized();
  return pose;
}

}  // namespace dlo::compare
