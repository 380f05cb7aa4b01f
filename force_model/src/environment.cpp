#include "dlo/force_model/environment.hpp"

#include <algorithm>
#include <cmath>

#include "require.hpp"
#include "solid_samples.hpp"

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

void check(const Solid& solid) {
  require_not_negative("Solid", "stiffness", solid.stiffness);
  require(solid.samples >= 1, "Solid", "samples", solid.samples, ">= 1");
  require(solid.body.centre().allFinite() && solid.body.axes().allFinite(), "Solid", "centre",
          solid.body.centre().norm(), "finite, like its axes");
}

void add_solid_forces(const Solid& solid, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                      Eigen::Ref<Eigen::Matrix3Xd> forces) {
  const auto at = [&points](Eigen::Index i) -> Eigen::Vector3d { return points.col(i); };
  for_each_push(solid, points.cols(), at, [&](const SolidPush& push) {
    forces.col(push.point) += (1 - push.share) * push.force;
    if (push.share > 0) forces.col(push.point + 1) += push.share * push.force;
  });
}

double solid_energy(const Solid& solid, const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  const auto at = [&points](Eigen::Index i) -> Eigen::Vector3d { return points.col(i); };
  double energy = 0;
  for_each_push(solid, points.cols(), at, [&](const SolidPush& push) {
    energy -= push.force.dot(push.gap.gradient) * push.gap.value / 2;
  });
  return energy;
}

Eigen::Vector3d spring_force(double stiffness, const Eigen::Vector3d& anchor,
                             const Eigen::Vector3d& position) {
  return stiffness * (anchor - position);
}

}  // namespace dlo::force_model
