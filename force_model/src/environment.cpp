#include "dlo/force_model/environment.hpp"

#include <algorithm>
#include <cmath>

#include "require.hpp"

namespace dlo::force_model {
namespace {

double depth(const Wall& wall, const Eigen::Vector3d& position) {
  return std::max(0.0, (wall.point - position).dot(wall.normal));
}

}  // namespace

void check(const Wall& wall) {
  require_not_negative("Wall", "stiffness", wall.stiffness);
  const double length = wall.normal.norm();
  require(std::abs(length - 1) < 1e-9, "Wall", "length of the normal", length, "1");
  require(wall.point.allFinite(), "Wall", "point", wall.point.norm(), "finite");
}

Eigen::Vector3d wall_force(const Wall& wall, const Eigen::Vector3d& position) {
  return wall.stiffness * depth(wall, position) * wall.normal;
}

double wall_energy(const Wall& wall, const Eigen::Vector3d& position) {
  const double d = depth(wall, position);
  return wall.stiffness * d * d / 2;
}

Eigen::Vector3d spring_force(double stiffness, const Eigen::Vector3d& anchor,
                             const Eigen::Vector3d& position) {
  return stiffness * (anchor - position);
}

}  // namespace dlo::force_model
