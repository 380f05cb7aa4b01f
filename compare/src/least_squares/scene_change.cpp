#include "least_squares/scene_change.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace dlo::compare {

Eigen::Matrix3Xd rotation_axes(const Eigen::Vector3d& direction,
                               const std::optional<Eigen::Vector3d>& normal) {
  if (normal) return *normal;
  Eigen::Matrix3Xd ways(3, 2);
  const Eigen::Vector3d first = direction.unitOrthogonal();
  ways << first, direction.cross(first);
  return ways;
}

Eigen::Matrix3Xd translation_directions(const std::optional<Eigen::Vector3d>& normal) {
  if (!normal) return Eigen::Matrix3d::Identity();
  return rotation_axes(*normal, std::nullopt);
}

void rotate_clamp(Gripper& clamp, const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  if (!(angle > 0)) return;
  const Eigen::AngleAxisd rotation(angle, turn / angle);
  clamp.direction = rotation * *clamp.direction;
  if (clamp.frame && clamp.frame->d1) clamp.frame->d1 = rotation * *clamp.frame->d1;
}

bool is_bent_by_weight_alone(const Scene& scene) {
  const bool moves = std::ranges::any_of(
      scene.grippers, [](const Gripper& gripper) { return !gripper.trajectory.empty(); });
  return scene.weight_per_length().norm() > 0 && scene.loads.empty() &&
         scene.distributed_loads.empty() && !scene.drag && scene.obstacles.empty() && !moves;
}

void rotate_scene(Scene& scene, const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  if (!(angle > 0)) return;
  const Eigen::AngleAxisd rotation(angle, turn / angle);
  const Eigen::Vector3d about = scene.grippers.front().position;
  scene.gravity = rotation * scene.gravity;
  for (Gripper& gripper : scene.grippers) {
    gripper.position = about + rotation * (gripper.position - about);
    if (gripper.direction) rotate_clamp(gripper, turn);
  }
}

void increase_natural_curvature(Scene& scene, std::size_t term, const Eigen::Vector2d& curvature) {
  if (curvature.isZero(0)) return;
  if (term == 0) {
    scene.natural_strain.head<2>() += curvature;
    return;
  }
  if (scene.natural_variation.size() < term) {
    scene.natural_variation.resize(term, Eigen::Vector2d::Zero());
  }
  scene.natural_variation[term - 1] += curvature;
}

}  // namespace dlo::compare
