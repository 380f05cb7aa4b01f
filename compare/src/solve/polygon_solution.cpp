#include "solve/polygon_solution.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/timer.hpp"
#include "dlo/compare/error.hpp"
#include "polygon/energy_problems.hpp"
#include "polygon/natural_plane.hpp"
#include "scene/scene_problem.hpp"
#include "solve/held_frames.hpp"

namespace dlo::compare {
namespace {

/// Segment whose length differs most from its rest length, relative to it.
struct Strain {
  Eigen::Index segment = 0;
  double share = 0;  // relative elongation, positive if longer
};

Strain largest_of(const force_model::Rod& rod, const Eigen::Matrix3Xd& points) {
  const Eigen::Index n = rod.rest_lengths.size();
  const Eigen::ArrayXd lengths = (points.rightCols(n) - points.leftCols(n)).colwise().norm();
  const Eigen::ArrayXd strain = lengths / rod.rest_lengths.array() - 1;
  Strain result;
  strain.abs().maxCoeff(&result.segment);
  result.share = strain[result.segment];
  return result;
}

/// Returns for each point whether a gripper holds it.
std::vector<bool> held_points(const force_model::Rod& rod, Eigen::Index count) {
  std::vector<bool> held(static_cast<std::size_t>(count), false);
  for (const force_model::Grip& grip : rod.grips) {
    std::fill_n(held.begin() + grip.first_point, grip.targets.cols(), true);
  }
  return held;
}

/// Returns the actions on a polygon: those of the grippers, the loads, and forces of obstacles on
/// points that no gripper holds. Their number is the same for every shape of a rod.
std::vector<energy_model::Action> actions_on(const force_model::Rod& rod,
                                             const Eigen::Matrix3Xd& points,
                                             const std::vector<GripperLoad>& grippers) {
  std::vector<energy_model::Action> actions;
  for (std::size_t i = 0; i < grippers.size(); ++i) {
    actions.push_back({rod.grips[i].reference, grippers[i].force, grippers[i].torque});
  }
  const std::vector<bool> held = held_points(rod, points.cols());
  Eigen::Matrix3Xd pushes = Eigen::Matrix3Xd::Zero(3, points.cols());
  for (const force_model::Wall& wall : rod.walls) {
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      pushes.col(i) += force_model::wall_force(wall, points.col(i));
    }
  }
  for (const force_model::Solid& solid : rod.solids) {
    force_model::add_solid_forces(solid, points, pushes);
  }
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    actions.push_back({points.col(i), rod.loads.col(i), Eigen::Vector3d::Zero()});
    if (held[static_cast<std::size_t>(i)]) continue;
    actions.push_back({points.col(i), pushes.col(i), Eigen::Vector3d::Zero()});
  }
  return actions;
}

/// Returns the potential of a solid's forces on samples of which a free point bears a part [J].
double contact_energy(const force_model::Solid& solid, const Eigen::Matrix3Xd& points,
                      const std::vector<bool>& held) {
  double energy = force_model::solid_energy(solid, points);
  for (auto begin = held.begin(); begin != held.end();) {
    const auto end = std::find(begin, held.end(), !*begin);
    if (*begin) {
      energy -=
          force_model::solid_energy(solid, points.middleCols(begin - held.begin(), end - begin));
    }
    begin = end;
  }
  return energy;
}

}  // namespace

Solution polygon_solution(const Scene& scene, const ForceModelSettings& settings,
                          const Discretisation& discretisation, const force_model::Rod& rod,
                          const Eigen::Matrix3Xd& points) {
  const force_model::RodEnergy inner = force_model::energy(rod, points);
  const Eigen::Matrix3Xd offset = points.colwise() - rod.grips.front().reference;
  Solution solution;
  solution.shape = discretisation.shape(points);
  solution.parameters = discretisation.parameters;
  solution.neglected = neglected_by_polygon(scene, settings);
  SceneEnergies& energy = solution.energy;
  energy.bending = inner.bending;
  energy.twisting = inner.twist;
  solution.twists = twisted_parts(scene, rod, points);
  energy.stretch = inner.stretch;
  energy.gravity = -discretisation.weights.cwiseProduct(offset).sum();
  energy.load = -(rod.loads - discretisation.weights).cwiseProduct(offset).sum();
  const std::vector<bool> held = held_points(rod, points.cols());
  solution.obstacles.assign(scene.obstacles.size(), Eigen::Vector3d::Zero());
  std::size_t index = 0;
  for (const force_model::Wall& wall : rod.walls) {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      if (held[static_cast<std::size_t>(i)]) continue;
      force += force_model::wall_force(wall, points.col(i));
      energy.contact += force_model::wall_energy(wall, points.col(i));
    }
    if (index < discretisation.walls.size()) {
      solution.obstacles[discretisation.walls[index++]] = force;
    }
  }
  for (std::size_t k = 0; k < rod.solids.size(); ++k) {
    Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, points.cols());
    force_model::add_solid_forces(rod.solids[k], points, forces);
    energy.contact += contact_energy(rod.solids[k], points, held);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      if (held[static_cast<std::size_t>(i)]) continue;
      solution.obstacles[discretisation.solids[k]] += forces.col(i);
    }
  }
  if (has_friction_contact(scene, solution.obstacles)) solution.neglected.emplace_back("friction");
  return solution;
}

std::vector<GripperLoad> gripper_loads(force_model::Rod rod, const Eigen::Matrix3Xd& points) {
  rod.walls.clear();
  rod.solids.clear();
  const std::vector<force_model::GripReaction> reactions = force_model::grip_reactions(rod, points);
  std::vector<GripperLoad> loads;
  loads.reserve(reactions.size());
  for (const force_model::GripReaction& reaction : reactions) {
    loads.push_back({reaction.force, reaction.torque});
  }
  return loads;
}

energy_model::Imbalance polygon_imbalance(const force_model::Rod& rod,
                                          const Eigen::Matrix3Xd& points,
                                          const std::vector<GripperLoad>& grippers) {
  // The positions of a segment's ends are rounded to eps |P|, which changes its force by
  // c_c / L times that. The factor 8 allows for the sum of several such forces; it is not measured.
  constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
  const double per_length = rod.c_c / rod.rest_lengths.minCoeff();
  const double least =
      rounding * per_length * points.cwiseAbs().maxCoeff() / energy_model::allowed_imbalance;
  return energy_model::imbalance_of(
      actions_on(rod, points, grippers),
      {.force = {least, 0, 0}, .couple = {least * rod.length(), 0, 0}});
}

double allowed_rest_imbalance(const force_model::Rod& rod, const Eigen::Matrix3Xd& points,
                              const Eigen::Matrix3Xd& to_rest) {
  const Eigen::Matrix3Xd rest = points + to_rest;
  const std::vector<GripperLoad> grippers = gripper_loads(rod, points);
  const std::vector<energy_model::Action> here = actions_on(rod, points, grippers);
  const std::vector<energy_model::Action> rest_actions =
      actions_on(rod, rest, gripper_loads(rod, rest));
  const Eigen::Vector3d& origin = here.front().point;
  double force = 0;
  double moment = 0;
  for (std::size_t i = 0; i < here.size(); ++i) {
    force += (rest_actions[i].force - here[i].force).norm();
    moment += (rest_actions[i].moment_about(origin) - here[i].moment_about(origin)).norm();
  }
  const energy_model::Imbalance scale = polygon_imbalance(rod, points, grippers);
  return energy_model::allowed_imbalance +
         std::max(force / scale.largest_force, moment / scale.largest_moment);
}

BalancedGrippers balanced(const Scene& scene, const force_model::Rod& rod,
                          const Eigen::Matrix3Xd& points, std::vector<GripperLoad> grippers,
                          double allowed, const char* model) {
  const energy_model::Imbalance imbalance = polygon_imbalance(rod, points, grippers);
  if (imbalance.share() <= allowed) return {std::move(grippers), imbalance.share()};
  throw ConvergenceError(fmt::format("{}: the {} model did not converge to an equilibrium: {}",
                                     scene.file, model, imbalance.text()));
}

void require_unstrained(const Scene& scene, const ForceModelSettings& settings,
                        const Discretisation& discretisation, const Eigen::Matrix3Xd& points,
                        const char* model) {
  const Strain strain = largest_of(discretisation.rod, points);
  const double allowed = largest_strain(scene, settings);
  if (std::abs(strain.share) <= allowed) return;
  const double c_c = discretisation.rod.c_c;
  throw ConvergenceError(fmt::format(
      "{}: the {} model did not converge to a shape: segment {} of {} is {:.3g} % {} than at rest, "
      "a tension of {:.3g} N with c_c = {:.4g} N (allowed: {:g} %; more points than {} may do{})",
      scene.file, model, strain.segment + 1, discretisation.rod.rest_lengths.size(),
      std::abs(strain.share) * 100, strain.share > 0 ? "longer" : "shorter", strain.share * c_c,
      c_c, allowed * 100, settings.points,
      settings.c_c ? "" : ", and a rod that is this soft needs its c_c given"));
}

LowestPolygon lowest_polygon(const Scene& scene, const ForceModelSettings& settings,
                             const Discretisation& discretisation, const SolveOptions& options) {
  const energy_model::PolygonProblem problem =
      polygon_problem(discretisation.rod, settings.joint_law);
  const double allowed = largest_strain(scene, settings);
  const TimeLimit time(options.time_limit);
  energy_model::PolygonOptions polygon_options;
  polygon_options.max_evaluations = options.max_evaluations;
  LowestPolygon lowest;
  bool lowest_is_shape = false;
  for (std::size_t i = 0; i < discretisation.starts.size(); ++i) {
    polygon_options.time_limit = time.left();
    if (i > 0 && polygon_options.time_limit <= 0) break;
    energy_model::PolygonResult result =
        energy_model::solve_polygon(problem, discretisation.starts[i], polygon_options);
    lowest.evaluations += result.evaluations;
    lowest.seconds += result.seconds;
    // Mirror images have the same energy up to rounding; the tolerance keeps the image of the first
    // start.
    const double size = std::abs(result.energy) + std::abs(lowest.result.energy);
    const bool lower = result.energy < lowest.result.energy - 1e-9 * size;
    const bool is_shape = energy_model::succeeded(result.status) &&
                          std::abs(largest_of(discretisation.rod, result.points).share) <= allowed;
    const bool solved =
        energy_model::succeeded(result.status) && !energy_model::succeeded(lowest.result.status);
    const bool better = is_shape ? !lowest_is_shape || lower : !lowest_is_shape && solved;
    if (i > 0 && !better) continue;
    lowest.start = i;
    lowest.result = std::move(result);
    lowest_is_shape = is_shape;
  }
  if (!energy_model::succeeded(lowest.result.status)) {
    throw ConvergenceError(fmt::format("{}: the chain model did not converge: {} ({} evaluations)",
                                       scene.file, lowest.result.message, lowest.evaluations));
  }
  require_unstrained(scene, settings, discretisation, lowest.result.points, "chain");
  lowest.rod = discretisation.rod;
  if (!models_twist(scene, settings)) return lowest;
  lowest.untwisted = lowest.result.points;
  lowest.rod = with_frames(scene, discretisation, lowest.untwisted);
  polygon_options.time_limit = std::max(time.left(), options.time_limit / 4);
  lowest.result = energy_model::twist_polygon(polygon_problem(lowest.rod, settings.joint_law),
                                              lowest.untwisted, polygon_options);
  lowest.evaluations += lowest.result.evaluations;
  lowest.seconds += lowest.result.seconds;
  if (!energy_model::succeeded(lowest.result.status)) {
    throw ConvergenceError(
        fmt::format("{}: the chain model did not converge: {} ({} evaluations, all with twist)",
                    scene.file, lowest.result.message, lowest.evaluations));
  }
  require_unstrained(scene, settings, discretisation, lowest.result.points, "chain");
  lowest.rod.twist.angles = Eigen::Map<const Eigen::VectorXd>(
      lowest.result.twists.data(), static_cast<Eigen::Index>(lowest.result.twists.size()));
  return lowest;
}

}  // namespace dlo::compare
