#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

/// Largest difference between the axes of great circles that count as one [-].
constexpr double great_circle_tolerance = 1e-6;

/// Weights of Hermite's cubic between two poses, or of its time derivative.
struct Hermite {
  double start;               ///< weight of the value at the first pose
  double change;              ///< weight of the change to the second pose
  double rate_from, rate_to;  ///< weights of the rates at both poses
};

/// Returns the weights at a time. @param derivative  order of the derivative: 0, 1 or 2
Hermite hermite(const TrajectoryLeg& leg, double time, int derivative) {
  const double h = leg.to.time - leg.from.time;
  const double u = (time - leg.from.time) / h;
  const double v = 1 - u;
  if (derivative == 0) return {1, u * u * (1 + 2 * v), h * u * v * v, -h * u * u * v};
  if (derivative == 1) return {0, 6 * u * v / h, v * (1 - 3 * u), u * (3 * u - 2)};
  return {0, 6 * (v - u) / (h * h), (6 * u - 4) / h, (6 * u - 2) / h};
}

/// Returns the factor that limits a speed to three times that of the slower side [-].
double speed_share(double speed, double before, double after) {
  const double most = 3 * std::min(before, after);
  return speed > most ? most / speed : 1;
}

/// Great circle from one direction to the next.
struct GreatCircle {
  double angle = 0;  ///< angle between the directions [rad]
  /// Unit vector; zero if both directions are equal.
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
};

GreatCircle circle_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d across = from.cross(to);
  const double sine = across.norm();
  if (!(sine > 0)) return {};
  return {std::atan2(sine, from.dot(to)), across / sine};
}

/// Returns the angular velocity at a pose between two great circles [rad/s]; 0 if they differ.
double turning_rate(const GreatCircle& before, const GreatCircle& after, double h_before,
                    double h_after) {
  if (!((before.axis - after.axis).norm() < great_circle_tolerance)) return 0;
  const double s_before = before.angle / h_before;
  const double s_after = after.angle / h_after;
  const double rate = (h_after * s_before + h_before * s_after) / (h_before + h_after);
  return rate * speed_share(rate, s_before, s_after);
}

/// Returns the rate of change at pose b of a vector that each pose has, limited to three times the
/// slower mean rate before and after b; 0 if the angle between these two rates is not acute.
template <class Value>
Eigen::Vector3d velocity_between(const Pose& a, const Pose& b, const Pose& c, const Value& value) {
  const double h_before = b.time - a.time;
  const double h_after = c.time - b.time;
  const Eigen::Vector3d before = (value(b) - value(a)) / h_before;
  const Eigen::Vector3d after = (value(c) - value(b)) / h_after;
  if (!(before.dot(after) > 0)) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d v = (h_after * before + h_before * after) / (h_before + h_after);
  return v * speed_share(v.norm(), before.norm(), after.norm());
}

Eigen::Vector3d position_of(const Pose& pose) { return pose.position; }
Eigen::Vector3d roll_of(const Pose& pose) {
  return pose.roll.value_or(0) * Eigen::Vector3d::UnitX();
}

}  // namespace

Eigen::Vector3d TrajectoryLeg::position(double time, int derivative) const {
  const Hermite at = hermite(*this, time, derivative);
  return at.start * from.position + at.change * (to.position - from.position) +
         at.rate_from * velocity_from + at.rate_to * velocity_to;
}

double TrajectoryLeg::turned(double time, int derivative) const {
  const Hermite at = hermite(*this, time, derivative);
  return at.change * angle + at.rate_from * rate_from + at.rate_to * rate_to;
}

double TrajectoryLeg::rolled(double time, int derivative) const {
  const Hermite at = hermite(*this, time, derivative);
  return at.start * *from.roll + at.change * (*to.roll - *from.roll) +
         at.rate_from * roll_rate_from + at.rate_to * roll_rate_to;
}

TrajectoryLeg leg_after(const std::vector<Pose>& poses, std::size_t first) {
  const Pose& a = poses[first];
  const Pose& b = poses[first + 1];
  const bool begins = first == 0;
  const bool ends = first + 2 == poses.size();
  const Eigen::Vector3d still = Eigen::Vector3d::Zero();
  TrajectoryLeg leg;
  leg.from = a;
  leg.to = b;
  const auto rates = [&](const auto& value) {
    return std::pair(begins ? still : velocity_between(poses[first - 1], a, b, value),
                     ends ? still : velocity_between(a, b, poses[first + 2], value));
  };
  std::tie(leg.velocity_from, leg.velocity_to) = rates(position_of);
  if (a.roll) {
    const auto [from, to] = rates(roll_of);
    leg.roll_rate_from = from.x();
    leg.roll_rate_to = to.x();
  }
  if (!a.direction) return leg;
  const auto circle_of = [&](std::size_t i) {
    return circle_between(*poses[i].direction, *poses[i + 1].direction);
  };
  const GreatCircle circle = circle_of(first);
  if (!(circle.angle > 0)) return leg;
  const double h = b.time - a.time;
  leg.angle = circle.angle;
  leg.axis = circle.axis;
  if (!begins) {
    leg.rate_from = turning_rate(circle_of(first - 1), circle, a.time - poses[first - 1].time, h);
  }
  if (!ends) {
    leg.rate_to = turning_rate(circle, circle_of(first + 1), h, poses[first + 2].time - b.time);
  }
  return leg;
}

}  // namespace dlo::compare
