#include "polygon/natural_plane.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

/// Whether all grips and loads lie in the plane z = 0, to the last digit, and obstacles in reach
/// are symmetric about it.
bool lies_in_plane(const Scene& scene, const ForceModelSettings& settings) {
  const auto flat = [](const Eigen::Vector3d& vector) { return vector.z() == 0; };
  const auto is_in_plane = [&](const Gripper& gripper) {
    return flat(gripper.position) && (!gripper.direction || flat(*gripper.direction));
  };
  const auto flat_body = [&](const obstacle::Body& body) {
    if (body.is_half_space()) return flat(body.normal());
    return body.is_symmetric(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ(), scene.length);
  };
  const auto in_reach = obstacles_in_reach(scene, settings);
  return flat(scene.gravity) && (!scene.drag || flat(scene.drag->velocity)) &&
         std::all_of(scene.grippers.begin(), scene.grippers.end(), is_in_plane) &&
         std::all_of(scene.loads.begin(), scene.loads.end(),
                     [&](const PointLoad& load) { return flat(load.force); }) &&
         std::all_of(scene.distributed_loads.begin(), scene.distributed_loads.end(),
                     [&](const DistributedLoad& load) {
                       return std::all_of(load.force_per_length.begin(),
                                          load.force_per_length.end(), flat);
                     }) &&
         std::all_of(in_reach.begin(), in_reach.end(),
                     [&](std::size_t i) { return flat_body(scene.obstacles[i].body); });
}

}  // namespace

bool models_natural_curvature(const Scene& scene, const ForceModelSettings& settings) {
  return scene.naturally_curved() && settings.law == BendingLaw::hooke && scene.planar();
}

bool models_twist(const Scene& scene, const ForceModelSettings& settings) {
  return scene.prescribes_twist() && settings.law == BendingLaw::hooke && !scene.naturally_bent();
}

std::vector<std::string> neglected_by_polygon(const Scene& scene,
                                              const ForceModelSettings& settings) {
  std::vector<std::string> neglected;
  if (scene.prescribes_twist() && !models_twist(scene, settings)) neglected.emplace_back("twist");
  if (scene.naturally_curved() && !models_natural_curvature(scene, settings)) {
    neglected.emplace_back("natural curvature");
  }
  return neglected;
}

Scene without_neglected_properties(const Scene& scene, const ForceModelSettings& settings) {
  if (models_twist(scene, settings)) return scene;
  const bool curved = models_natural_curvature(scene, settings);
  return (curved ? scene : scene.without_natural_strain()).without_twist();
}

PlaneTransform::PlaneTransform(const Eigen::Vector3d& normal, Eigen::Vector3d origin)
    : turn_(Eigen::Quaterniond::FromTwoVectors(normal, Eigen::Vector3d::UnitZ())),
      origin_(std::move(origin)) {}

Eigen::Vector3d PlaneTransform::flat(const Eigen::Vector3d& vector) const {
  Eigen::Vector3d result = turn_ * vector;
  result.z() = 0;
  return result;
}

Scene PlaneTransform::transformed(const Scene& scene) const {
  Scene result = scene;
  result.gravity = flat(scene.gravity);
  for (Gripper& gripper : result.grippers) {
    gripper.position = flat(gripper.position - origin_);
    if (gripper.direction) gripper.direction = flat(*gripper.direction).normalized();
    if (gripper.frame && gripper.frame->d1) gripper.frame->d1 = turn_ * *gripper.frame->d1;
  }
  for (PointLoad& load : result.loads) load.force = flat(load.force);
  if (result.drag) result.drag->velocity = flat(result.drag->velocity);
  for (DistributedLoad& load : result.distributed_loads) {
    for (Eigen::Vector3d& q : load.force_per_length) q = flat(q);
  }
  for (Obstacle& obstacle : result.obstacles) {
    obstacle.body = obstacle.body.transformed(origin_, turn_, 1);
  }
  for (const std::size_t i : obstacles_in_reach(scene)) {
    obstacle::Body& body = result.obstacles[i].body;
    if (!body.is_half_space()) continue;
    const Eigen::Vector3d normal = flat(scene.obstacles[i].body.normal());
    body = obstacle::Body::half_space(body.centre(), normal).enlarged(body.radius());
  }
  return result;
}

Eigen::Matrix3Xd PlaneTransform::transformed_points(const Eigen::Matrix3Xd& points) const {
  Eigen::Matrix3Xd result = turn_ * (points.colwise() - origin_);
  result.row(2).setZero();
  return result;
}

std::optional<PlaneTransform> plane_transform(const Scene& scene,
                                              const ForceModelSettings& settings) {
  if (!models_natural_curvature(scene, settings) || lies_in_plane(scene, settings)) {
    return std::nullopt;
  }
  return PlaneTransform(scene.plane_normal().value(), scene.grippers.front().position);
}

}  // namespace dlo::compare
