#include "dlo/compare/paper_joint.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace dlo::compare {
namespace {

void require_joint(const char* function, double c_b, double length) {
  if (c_b > 0 && length > 0 && std::isfinite(c_b) && std::isfinite(length)) return;
  throw std::invalid_argument(
      fmt::format("{}: c_b = {}, length = {}, must be > 0 and finite", function, c_b, length));
}

void require_angle(const char* function, double angle) {
  if (angle >= 0 && angle <= std::numbers::pi) return;
  throw std::invalid_argument(fmt::format("{}: angle = {}, must be 0 to pi", function, angle));
}

}  // namespace

double paper_joint_moment(double c_b, double length, double angle) {
  require_joint("paper_joint_moment", c_b, length);
  require_angle("paper_joint_moment", angle);
  const double half = std::sin(angle / 2);
  return 2 * c_b * length * half * half * half;  // (1)
}

double paper_joint_angle(double c_b, double length, double moment) {
  require_joint("paper_joint_angle", c_b, length);
  if (!(moment >= 0 && moment <= 2 * c_b * length)) {
    throw std::invalid_argument(
        fmt::format("paper_joint_angle: moment = {}, must be 0 to {}", moment, 2 * c_b * length));
  }
  return 2 * std::asin(std::cbrt(moment / (2 * c_b * length)));
}

double equivalent_bending_stiffness(double c_b, double length, double angle) {
  const double moment = paper_joint_moment(c_b, length, angle);
  return angle > 0 ? moment * length / angle : 0;  // (2)
}

}  // namespace dlo::compare
