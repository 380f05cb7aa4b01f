#include "polygon/energy_problems.hpp"

#include <Eigen/Geometry>
#include <vector>

#include "polygon/point_layout.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {

std::optional<ChainScene> chain_scene(const Scene& scene, const Discretisation& discretisation,
                                      const ForceModelSettings& settings) {
  const Gripper& grip = scene.grippers.front();
  const bool end_clamp =
      scene.grippers.size() == 1 && grip.direction && (grip.at == 0 || grip.at == scene.length);
  if (!end_clamp || discretisation.rod.has_obstacles()) return std::nullopt;
  const bool reversed = grip.at != 0;
  const Eigen::Index N = settings.points;
  std::vector<Eigen::Vector3d> forces = {scene.weight_per_length() * scene.length};
  for (const PointLoad& load : scene.loads) forces.push_back(load.force);
  for (const DistributedLoad& load : scene.distributed_loads) {
    for (const Eigen::Vector3d& q : load.force_per_length) forces.emplace_back(q * scene.length);
  }
  const std::optional<energy_model::Plane> plane = energy_model::find_plane(
      grip.position, reversed ? Eigen::Vector3d(-*grip.direction) : *grip.direction, forces);
  if (!plane) return std::nullopt;
  ChainScene result{.plane = *plane, .problem = {}};
  energy_model::ChainProblem& problem = result.problem;
  problem.segment_lengths = discretisation.rod.rest_lengths;
  problem.law = settings.law == BendingLaw::paper
                    ? energy_model::JointLaw::paper
                    : settings.joint_law.value_or(energy_model::JointLaw::hooke);
  const force_model::Bending& bending = discretisation.rod.bending;
  problem.stiffness = bending.stiffness;
  problem.stiffnesses = bending.stiffnesses;
  problem.natural_turns = bending.natural_turns;
  if (bending.natural_turns.size() > 0) {
    // natural_turns are positive from x to y of space, which may be the negative sense in the
    // chain's plane.
    const double z = plane->x.cross(plane->y).z() > 0 ? 1 : -1;
    problem.natural_turns *= reversed ? -z : z;
  }
  if (reversed) {
    problem.stiffnesses.reverseInPlace();
    problem.natural_turns.reverseInPlace();
  }
  problem.node_forces.resize(2, N);
  for (Eigen::Index i = 0; i < N; ++i) {
    // The chain starts in the gripper, which may be at either end of the rod.
    const Eigen::Index from = reversed ? N - 1 - i : i;
    problem.node_forces.col(i) = plane->coordinates(discretisation.rod.loads.col(from));
  }
  const Eigen::Vector3d first = discretisation.starts.front().col(reversed ? N - 1 : 0);
  problem.start = plane->coordinates(first - plane->origin);
  return result;
}

Eigen::Matrix3Xd ChainScene::to_space(const Eigen::Matrix2Xd& points) const {
  return (plane.x * points.row(0) + plane.y * points.row(1)).colwise() + plane.origin;
}

energy_model::PolygonProblem polygon_problem(const force_model::Rod& rod,
                                             std::optional<energy_model::JointLaw> joint_law) {
  energy_model::PolygonProblem problem;
  problem.rest_lengths = rod.rest_lengths;
  problem.stretch_stiffness = rod.c_c;
  problem.node_forces = rod.loads;
  problem.law = rod.bending.law == force_model::BendingLaw::paper
                    ? energy_model::JointLaw::paper
                    : joint_law.value_or(energy_model::JointLaw::hooke);
  problem.stiffness = rod.bending.stiffness;
  problem.stiffnesses = rod.bending.stiffnesses;
  problem.natural_turns = rod.bending.natural_turns;
  for (const force_model::Grip& grip : rod.grips) {
    for (Eigen::Index k = 0; k < grip.targets.cols(); ++k) {
      problem.held.push_back({grip.first_point + k, grip.targets.col(k)});
    }
  }
  for (const force_model::TwistedSpan& span : force_model::twisted_spans(rod)) {
    problem.twists.push_back({span.first_segment, span.last_segment, span.first_d1, span.last_d1,
                              span.compliance, span.angle});
  }
  for (const force_model::Wall& wall : rod.walls) {
    const obstacle::Body body = obstacle::Body::half_space(wall.point, wall.normal);
    problem.obstacles.push_back({body, wall.stiffness});
  }
  for (const force_model::Solid& solid : rod.solids) {
    problem.obstacles.push_back({solid.body, solid.stiffness, solid.samples});
  }
  return problem;
}

energy_model::Problem energy_problem(const Scene& scene) {
  require_slack(scene);
  return scene_problem(scene);
}

}  // namespace dlo::compare
