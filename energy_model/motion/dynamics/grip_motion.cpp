#include "dlo/energy_model/grip_motion.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/require.hpp"

namespace dlo::energy_model {

GripMotion fixed_grip(const Eigen::Vector3d& position) { return moving(position, {}, {}, {}, {}); }

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
      const MotionValue displacement = distance(time);
      pose.position += displacement.value * axis;
      pose.velocity = displacement.rate * axis;
      pose.acceleration = displacement.acceleration * axis;
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

}  // namespace dlo::energy_model
