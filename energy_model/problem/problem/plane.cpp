#include "dlo/energy_model/plane.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/spin.hpp"

namespace dlo::energy_model {

std::optional<Plane> find_plane(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                const std::vector<Eigen::Vector3d>& forces) {
  Plane plane;
  plane.origin = origin;
  plane.x = direction.normalized();
  Eigen::Vector3d furthest = Eigen::Vector3d::Zero();
  double largest = 0;
  for (const Eigen::Vector3d& force : forces) {
    largest = std::max(largest, force.norm());
    const Eigen::Vector3d part = part_across(force, plane.x);
    if (part.norm() > furthest.norm()) furthest = part;
  }
  if (furthest.norm() <= planar_tolerance * largest || largest == 0) {
    furthest = part_across(Eigen::Vector3d::UnitX(), plane.x);
    if (furthest.norm() < 1e-6) furthest = part_across(Eigen::Vector3d::UnitY(), plane.x);
  }
  plane.y = furthest.normalized();
  // A second projection makes x and y orthogonal to rounding even for a nearly parallel force.
  plane.y = part_across(plane.y, plane.x).normalized();
  const Eigen::Vector3d normal = plane.normal();
  for (const Eigen::Vector3d& force : forces) {
    if (std::abs(normal.dot(force)) > planar_tolerance * largest) return std::nullopt;
  }
  return plane;
}

}  // namespace dlo::energy_model
