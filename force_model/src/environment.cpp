#include "dlo/force_model/environment.hpp"

#include <algorithm>

namespace dlo::force_model {
namespace {

double depth(const Wall& wall, const Eigen::Vector3d& position) {
  return std::max(0.0, (wall.point - position).dot(wall.normal));
}

}  // namespace

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
