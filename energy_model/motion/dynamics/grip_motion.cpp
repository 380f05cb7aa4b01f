#include "dlo/energy_model/grip_motion.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/require.hpp"

namespace dlo::energy_model {
namespace {

/// Returns the second derivatives of a cubic spline at its knots; its first derivative is zero at
/// both ends.
Eigen::MatrixX3d spline_curvatures(const std::vector<TimedPose>& poses) {
  const auto n = static_cast<Eigen::Index>(poses.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(n, 3);
  // Contributions of each interval to the slopes at its knots, which are equal from both sides.
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double h = poses[k + 1].time - poses[k].time;
    const Eigen::Vector3d slope = (poses[k + 1].position - poses[k].position) / h;
    matrix.block<2, 2>(i, i) += (Eigen::Matrix2d() << h / 3, h / 6, h / 6, h / 3).finished();
    right.row(i) += slope.transpose();
    right.row(i + 1) -= slope.transpose();
  }
  return matrix.partialPivLu().solve(right);
}

/// Returns 10 x^3 - 15 x^4 + 6 x^5 and its derivatives by x.
MotionValue quintic(double x) {
  return {x * x * x * (10 + x * (6 * x - 15)), 30 * x * x * (1 - x) * (1 - x),
          60 * x * (1 - x) * (1 - 2 * x)};
}

}  // namespace

GripMotion standing(const Eigen::Vector3d& position) { return moving(position, {}, {}, {}, {}); }

GripMotion moving(const Eigen::Vector3d& position, const Eigen::Vector3d& along,
                  std::function<MotionValue(double)> distance, const Eigen::Vector3d& about,
                  std::function<MotionValue(double)> angle) {
  if (distance) require_positive("moving", "length of along", along.norm());
  if (angle) require_positive("moving", "length of about", about.norm());
  return [position, axis = along.normalized().eval(), distance = std::move(distance),
          pivot = about.normalized().eval(), angle = std::move(angle)](double time) {
    GripPose pose;
    pose.position = position;
    if (distance) {
      const MotionValue gone = distance(time);
      pose.position += gone.value * axis;
      pose.velocity = gone.rate * axis;
      pose.acceleration = gone.acceleration * axis;
    }
    if (angle) {
      const MotionValue turned = angle(time);
      pose.turn = Eigen::AngleAxisd(turned.value, pivot);
      pose.angular_velocity = turned.rate * pivot;
      pose.angular_acceleration = turned.acceleration * pivot;
    }
    return pose;
  };
}

std::function<MotionValue(double)> smooth_step(double begin, double end, double size) {
  require(begin < end, "smooth_step", "end", end, "> begin");
  return [begin, takes = end - begin, size](double time) {
    const double x = std::clamp((time - begin) / takes, 0.0, 1.0);
    const double y = 1 - x;
    // 35 x^4 - 84 x^5 + 70 x^6 - 20 x^7, whose derivative is 140 x^3 (1 - x)^3
    MotionValue result;
    result.value = size * std::pow(x, 4) * (35 + x * (-84 + x * (70 - 20 * x)));
    result.rate = size * 140 * std::pow(x * y, 3) / takes;
    result.acceleration = size * 420 * std::pow(x * y, 2) * (1 - 2 * x) / (takes * takes);
    return result;
  };
}

GripMotion interpolated(std::vector<TimedPose> poses) {
  require(poses.size() >= 2, "interpolated", "poses.size()", static_cast<double>(poses.size()),
          ">= 2");
  for (std::size_t i = 1; i < poses.size(); ++i) {
    require(poses[i].time > poses[i - 1].time, "interpolated", "time", poses[i].time,
            "strictly increasing");
  }
  const Eigen::MatrixX3d curvatures = spline_curvatures(poses);
  return [poses = std::move(poses), curvatures](double time) {
    GripPose pose;
    if (time <= poses.front().time || time >= poses.back().time) {
      const TimedPose& end = time <= poses.front().time ? poses.front() : poses.back();
      pose.position = end.position;
      pose.turn = end.turn;
      return pose;
    }
    std::size_t i = 0;
    while (time >= poses[i + 1].time) ++i;
    const auto row = static_cast<Eigen::Index>(i);
    const double h = poses[i + 1].time - poses[i].time;
    const double x = (time - poses[i].time) / h;
    const double y = 1 - x;
    const Eigen::Vector3d first = curvatures.row(row).transpose();
    const Eigen::Vector3d second = curvatures.row(row + 1).transpose();
    pose.position = y * poses[i].position + x * poses[i + 1].position +
                    h * h / 6 * ((y * y * y - y) * first + (x * x * x - x) * second);
    pose.velocity = (poses[i + 1].position - poses[i].position) / h +
                    h / 6 * ((1 - 3 * y * y) * first + (3 * x * x - 1) * second);
    pose.acceleration = y * first + x * second;
    const Eigen::Quaterniond from = poses[i].turn.normalized();
    const Eigen::AngleAxisd apart(poses[i + 1].turn.normalized() * from.conjugate());
    const MotionValue share = quintic(x);
    pose.turn =
        Eigen::Quaterniond(Eigen::AngleAxisd(share.value * apart.angle(), apart.axis())) * from;
    pose.angular_velocity = apart.angle() * share.rate / h * apart.axis();
    pose.angular_acceleration = apart.angle() * share.acceleration / (h * h) * apart.axis();
    return pose;
  };
}

}  // namespace dlo::energy_model
