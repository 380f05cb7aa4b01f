#include "dlo/compare/chain.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <optional>
#include <utility>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/energy_model/chain.hpp"
#include "polygon/energy_problems.hpp"
#include "polygon/natural_plane.hpp"
#include "solve/held_frames.hpp"
#include "solve/polygon_solution.hpp"
#include "solve/states.hpp"

namespace dlo::compare {
namespace {

/// Returns force and torque of the gripper on a polygon without stretch. The force balances all
/// loads; the torque includes that on the first segment.
GripperLoad gripper_load_on_chain(const Discretisation& discretisation, const ChainScene& chain,
                                  const energy_model::ChainResult& result) {
  GripperLoad load;
  load.force = -discretisation.rod.loads.rowwise().sum();
  const Eigen::Vector3d start = chain.to_space(result.points.leftCols<1>());
  const Eigen::Vector3d arm = start - discretisation.rod.grips.front().reference;
  load.torque = result.clamp_torque * chain.plane.x.cross(chain.plane.y) + arm.cross(load.force);
  return load;
}

template <typename Result>
void require_converged(const Scene& scene, const Result& result) {
  if (!energy_model::succeeded(result.status)) {
    throw ConvergenceError(fmt::format("{}: the chain model did not converge: {} ({} evaluations)",
                                       scene.file, result.message, result.evaluations));
  }
}

/// Returns std::nullopt if the chain is unstable, in its plane or out of it.
std::optional<Solution> solve_rigid_chain(const Scene& scene, const ForceModelSettings& settings,
                                          const Discretisation& discretisation,
                                          const ChainScene& chain, const SolveOptions& options) {
  const energy_model::ChainResult result = energy_model::solve_chain(
      chain.problem,
      {.max_evaluations = options.max_evaluations, .time_limit = options.time_limit});
  if (result.status == energy_model::SolveStatus::saddle) return std::nullopt;
  require_converged(scene, result);
  Eigen::Matrix3Xd points = chain.to_space(result.points);
  if (discretisation.rod.grips.front().first_point != 0) {
    points = points.rowwise().reverse().eval();
  }
  Solution solution = polygon_solution(scene, settings, discretisation, discretisation.rod, points);
  if (scene.stretch == Stretch::counted) solution.neglected.emplace_back("stretch");
  solution.status = result.status;
  solution.message = result.message;
  if (settings.joint_law) solution.energy.bending = result.bending_energy;
  solution.grippers = balanced(scene, discretisation.rod, points,
                               {gripper_load_on_chain(discretisation, chain, result)},
                               energy_model::allowed_imbalance, "chain")
                          .loads;
  solution.evaluations = result.evaluations;
  solution.seconds = result.seconds;
  return solution;
}

Solution solve_elastic_chain(const Scene& scene, const ForceModelSettings& settings,
                             const Discretisation& discretisation, const SolveOptions& options) {
  const LowestPolygon lowest = lowest_polygon(scene, settings, discretisation, options);
  const Eigen::Matrix3Xd& points = lowest.result.points;
  Solution solution = polygon_solution(scene, settings, discretisation, lowest.rod, points);
  if (settings.joint_law) {
    // All other bending energy is that of the rod's own law.
    const auto energy_with = [&](std::optional<energy_model::JointLaw> law) {
      Eigen::Matrix3Xd gradient(3, points.cols());
      return energy_model::polygon_energy(polygon_problem(lowest.rod, law), points, gradient);
    };
    solution.energy.bending += energy_with(settings.joint_law) - energy_with(std::nullopt);
  }
  solution.status = lowest.result.status;
  solution.message = lowest.result.message;
  std::vector<GripperLoad> grippers;
  Eigen::Index next = 0;  // grip_forces are in the order of the grips' points
  for (const force_model::Grip& grip : discretisation.rod.grips) {
    GripperLoad load;
    for (Eigen::Index k = 0; k < grip.targets.cols(); ++k) {
      const Eigen::Vector3d force = lowest.result.grip_forces.col(next++);
      const Eigen::Vector3d arm = points.col(grip.first_point + k) - grip.reference;
      load.force += force;
      load.torque += arm.cross(force);
    }
    grippers.push_back(load);
  }
  add_twisting_torques(lowest.rod, points, grippers);
  solution.grippers = balanced(scene, lowest.rod, points, std::move(grippers),
                               energy_model::allowed_imbalance, "chain")
                          .loads;
  solution.evaluations = lowest.evaluations;
  solution.seconds = lowest.seconds;
  return solution;
}

}  // namespace

Solution solve_chain(const Scene& scene, const ForceModelSettings& settings,
                     const SolveOptions& options) {
  if (const std::optional<PlaneTransform> turn = plane_transform(scene, settings)) {
    return solution_in_space(solve_chain(turn->transformed(scene), settings, options), *turn);
  }
  ForceModelSettings polygon = settings;
  polygon.joint_law.reset();
  const Discretisation discretisation = discretise(scene, polygon);
  const std::optional<ChainScene> chain = chain_scene(scene, discretisation, settings);
  std::optional<Solution> solution;
  if (chain) solution = solve_rigid_chain(scene, settings, discretisation, *chain, options);
  if (!solution) solution = solve_elastic_chain(scene, settings, discretisation, options);
  solution->model = Model::chain;
  return *std::move(solution);
}

Shape chain_from(const Scene& scene, const ForceModelSettings& settings, const Shape& start,
                 const SolveOptions& options) {
  if (const std::optional<PlaneTransform> turn = plane_transform(scene, settings)) {
    Shape transformed = start;
    transformed.points = turn->transformed_points(start.points);
    Shape result = chain_from(turn->transformed(scene), settings, transformed, options);
    result.points = turn->points_to_space(result.points);
    return result;
  }
  const Discretisation discretisation = discretise(scene, settings);
  Eigen::Matrix3Xd points = resample(start, discretisation.arc_length).points;
  // A planar shape lies in the plane only up to rounding, and its joints have rest angles in the
  // plane.
  if (models_natural_curvature(scene, settings)) points.row(2).setZero();
  // The frames, and the whole turns nearest to their twist, are those found from the lowest shape.
  const force_model::Rod rod = models_twist(scene, settings)
                                   ? lowest_polygon(scene, settings, discretisation, options).rod
                                   : discretisation.rod;
  const energy_model::PolygonResult result = energy_model::solve_polygon(
      polygon_problem(rod), points,
      {.max_evaluations = options.max_evaluations, .time_limit = options.time_limit});
  require_converged(scene, result);
  require_unstrained(scene, settings, discretisation, result.points, "chain");
  return discretisation.shape(result.points);
}

}  // namespace dlo::compare
