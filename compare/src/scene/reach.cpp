#include <algorithm>
#include <cmath>

#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

std::vector<std::size_t> obstacles_within(const Scene& scene, double distance) {
  const std::vector<double> clearances = obstacle_clearances(scene);
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < clearances.size(); ++i) {
    if (clearances[i] <= distance) result.push_back(i);
  }
  return result;
}

}  // namespace

std::vector<const Gripper*> grippers_by_arc_length(const Scene& scene) {
  std::vector<const Gripper*> along;
  for (const Gripper& gripper : scene.grippers) along.push_back(&gripper);
  std::ranges::stable_sort(along, {}, &Gripper::at);
  return along;
}

std::vector<double> obstacle_clearances(const Scene& scene) {
  const std::vector<const Gripper*> along = grippers_by_arc_length(scene);
  std::vector<double> clearances;
  if (along.empty()) return std::vector<double>(scene.obstacles.size());
  for (const Obstacle& obstacle : scene.obstacles) {
    const obstacle::Body& body = obstacle.body;
    const auto height = [&body](const Eigen::Vector3d& point) { return body.clearance(point); };
    double least = std::min(height(along.front()->position) - along.front()->at,
                            height(along.back()->position) - (scene.length - along.back()->at));
    for (std::size_t k = 0; k + 1 < along.size(); ++k) {
      const Eigen::Vector3d chord = along[k + 1]->position - along[k]->position;
      const double rod = along[k + 1]->at - along[k]->at;
      // Semi-axes of the ellipsoid: rod/2 along `chord`, sqrt(rod^2 - chord^2)/2 perpendicular to
      // it.
      const double along_normal = body.is_half_space() ? body.normal().dot(chord) : chord.norm();
      const double support =
          std::sqrt(std::max(0.0, rod * rod - chord.squaredNorm() + along_normal * along_normal)) /
          2;
      least = std::min(least, height((along[k]->position + along[k + 1]->position) / 2) - support);
    }
    clearances.push_back(least);
  }
  return clearances;
}

std::vector<std::size_t> obstacles_in_reach(const Scene& scene) {
  constexpr double rounding = 1e-9;
  return obstacles_within(scene, rounding * scene.length);
}

std::vector<std::size_t> obstacles_in_reach(const Scene& scene,
                                            const ForceModelSettings& settings) {
  const double stiffness =
      std::min(scene.axial_stiffness(), settings.c_c.value_or(scene.axial_stiffness()));
  const double load =
      scene.weight_per_length().norm() * scene.length + scene.total_load_magnitude();
  return obstacles_within(scene, 2 * scene.length * std::sqrt(load / stiffness));
}

std::vector<Eigen::Vector3d> expand_obstacle_forces(const Scene& scene,
                                                    const std::vector<std::size_t>& in_reach,
                                                    const std::vector<Eigen::Vector3d>& forces) {
  std::vector<Eigen::Vector3d> result(scene.obstacles.size(), Eigen::Vector3d::Zero());
  for (std::size_t k = 0; k < std::min(in_reach.size(), forces.size()); ++k) {
    result[in_reach[k]] = forces[k];
  }
  return result;
}

bool has_friction_contact(const Scene& scene, const std::vector<Eigen::Vector3d>& forces) {
  for (std::size_t i = 0; i < std::min(forces.size(), scene.obstacles.size()); ++i) {
    if (scene.obstacles[i].friction > 0 && forces[i].norm() > 0) return true;
  }
  return false;
}

bool is_friction_in_reach(const Scene& scene) {
  const auto rough = [](const Obstacle& obstacle) { return obstacle.friction > 0; };
  return std::ranges::any_of(scene.obstacles, rough) &&
         std::ranges::any_of(obstacles_in_reach(scene, scene.force_model),
                             [&](std::size_t i) { return rough(scene.obstacles[i]); });
}

}  // namespace dlo::compare
