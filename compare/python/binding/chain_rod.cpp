#include "chain_rod.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "dlo/compare/error.hpp"
#include "polygon/natural_plane.hpp"
#include "polygon/point_layout.hpp"
#include "solve/polygon_solution.hpp"

namespace dlo::python {
namespace {

using compare::InputError;

void hold_by_springs(force_model::Rod& rod, double stiffness) {
  if (!(stiffness > 0)) {
    throw InputError(fmt::format("grip_stiffness = {:g}: out of range (allowed: > 0)", stiffness));
  }
  for (force_model::Grip& grip : rod.grips) {
    if (grip.d1) {
      throw InputError("grip_stiffness: a gripper holds the rod's frame (allowed: None)");
    }
    grip.hold = force_model::GripHold::spring;
    grip.stiffness = stiffness;
  }
}

}  // namespace

ChainRod chain_rod(const SceneData& data, const std::optional<Eigen::Matrix3Xd>& points,
                   std::optional<double> grip_stiffness) {
  const compare::Scene& scene = data.scene;
  const compare::ForceModelSettings& settings = scene.force_model;
  if (compare::plane_transform(scene, settings)) {
    throw InputError(fmt::format(
        "{}: a rod that is intrinsically curved out of the plane z = 0 is not stepped from Python "
        "(allowed: in that plane, or dlo.solve(scene, model=\"force\"))",
        scene.file));
  }
  compare::Discretisation discretisation = compare::discretise(scene, settings);
  const bool hangs = discretisation.starts.size() == 1;
  force_model::BatchRod start;
  std::vector<std::size_t> all(scene.obstacles.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  if (hangs && !compare::models_twist(scene, settings)) {
    start.points = discretisation.starts.front();
    compare::set_obstacles(scene, all, discretisation);
    start.rod = discretisation.rod;
  } else {
    compare::LowestPolygon lowest = compare::lowest_polygon(scene, settings, discretisation, {});
    compare::set_obstacles(scene, all, discretisation);
    start.rod = std::move(lowest.rod);
    start.rod.walls = discretisation.rod.walls;
    start.rod.solids = discretisation.rod.solids;
    start.points = std::move(lowest.result.points);
  }
  if (points) {
    if (points->cols() != start.points.cols()) {
      throw InputError(fmt::format("points: {} points (allowed: {}, force_model.points)",
                                   points->cols(), start.points.cols()));
    }
    start.points = *points;
  }
  if (grip_stiffness) hold_by_springs(start.rod, *grip_stiffness);
  start.options = compare::step_options(settings, discretisation);
  return {std::move(start), std::move(discretisation)};
}

Eigen::Matrix3Xd moved_targets(const force_model::Rod& rod, std::size_t gripper,
                               const Eigen::Vector3d& position,
                               const std::optional<Eigen::Vector3d>& direction) {
  if (gripper >= rod.grips.size()) {
    throw InputError(fmt::format("gripper = {}: there is none (allowed: 0 to {})", gripper,
                                 rod.grips.size() - 1));
  }
  const force_model::Grip& grip = rod.grips[gripper];
  if (grip.targets.cols() == 1) {
    if (direction) throw InputError("direction: a pin has none (allowed: None)");
    return position;
  }
  const Eigen::Vector3d gripped_segment = grip.targets.col(1) - grip.targets.col(0);
  const double behind = (grip.reference - grip.targets.col(0)).dot(gripped_segment.normalized());
  if (direction && !(direction->norm() > 0)) {
    throw InputError("direction: must not be the zero vector");
  }
  // grip_targets() is not used because it allows at most half a segment behind a gripper.
  const Eigen::Vector3d along = direction ? direction->normalized() : gripped_segment.normalized();
  Eigen::Matrix3Xd targets(3, 2);
  targets.col(0) = position - behind * along;
  targets.col(1) = targets.col(0) + gripped_segment.norm() * along;
  return targets;
}

MovedWall moved_wall(const SceneData& data, const ChainRod& rod, std::size_t obstacle,
                     const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  const std::vector<std::size_t>& walls = rod.discretisation.walls;
  const auto found = std::find(walls.begin(), walls.end(), obstacle);
  if (found == walls.end()) {
    throw InputError(fmt::format("wall = {}: no plane among the scene's obstacles", obstacle));
  }
  if (!(normal.norm() > 0)) throw InputError("normal: must not be the zero vector");
  const auto index = static_cast<std::size_t>(found - walls.begin());
  force_model::Wall wall = rod.start.rod.walls[index];
  wall.normal = normal.normalized();
  wall.point = point + data.obstacle_offsets[obstacle] * wall.normal;
  return {index, wall};
}

}  // namespace dlo::python
