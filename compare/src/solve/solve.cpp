#include "dlo/compare/solve.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <utility>

#include "dlo/compare/chain.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force.hpp"
#include "dlo/compare/plan.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "polygon/shape_loads.hpp"
#include "scene/scene_problem.hpp"
#include "shape/curve.hpp"
#include "solve/held_frames.hpp"
#include "solve/stretch_effect.hpp"

namespace dlo::compare {
namespace {

/// Returns the force of the rod beyond `at` on the part before it: the negative sum of all that
/// acts on the part before.
/// @param solution  its grippers and contacts are used
/// @param of_shape  force on the part before, of loads that depend on the shape
Eigen::Vector3d section_force(const Scene& scene, const Solution& solution, double at,
                              const Eigen::Vector3d& of_shape) {
  const auto before = [&](double s) { return s < at || (s == at && at < scene.length); };
  Eigen::Vector3d sum = scene.weight_between(0, at) + scene.distributed_between(0, at) + of_shape;
  for (std::size_t i = 0; i < solution.grippers.size(); ++i) {
    if (before(scene.grippers[i].at)) sum += solution.grippers[i].force;
  }
  // A contact that extends past `at` is omitted. Its part before `at` acts across the rod on a
  // plane; on a curved obstacle the tension within the contact lacks that part.
  for (const energy_model::ContactPart& contact : solution.contacts) {
    if (before(contact.end)) sum += contact.force;
  }
  for (const PointLoad& load : scene.loads) {
    if (!load.follows && before(load.at)) sum += load.force;
  }
  return -sum;
}

/// Whether the rod touches a yielding obstacle, of whose pressure only the resultant is known.
bool touches_yielding_obstacle(const Scene& scene, const std::vector<Eigen::Vector3d>& forces) {
  for (std::size_t i = 0; i < forces.size(); ++i) {
    if (std::isfinite(scene.obstacles[i].stiffness) && forces[i].norm() > 0) return true;
  }
  return false;
}

/// Returns arc lengths limited to the rod.
/// @throws InputError for an arc length that is not on the rod
std::vector<double> all_on_rod(std::vector<double> arc_lengths, double length) {
  for (double& s : arc_lengths) {
    const std::optional<double> at = on_rod(s, length);
    if (!at) {
      throw InputError(fmt::format("solve: s = {:.9g} m (allowed: 0 to {:.9g} m)", s, length));
    }
    s = *at;
  }
  return arc_lengths;
}

Solution solution_with_stretch_effect(const StretchedRod& of, Model model,
                                      const std::vector<double>& arc_lengths) {
  Solution solution =
      solution_of(of.scene, model, of.rod, arc_lengths, obstacles_in_reach(of.scene));
  solution.stretch = of.effect;
  solution.stretch_decision = of.decision;
  if (of.neglects_stretch) solution.neglected.emplace_back("stretch");
  return solution;
}

}  // namespace

Solution solution_of(const Scene& scene, Model model, const energy_model::Equilibrium& equilibrium,
                     const std::vector<double>& arc_lengths,
                     const std::vector<std::size_t>& obstacles) {
  constexpr int default_samples = 101;
  const std::vector<double> samples = arc_lengths.empty()
                                          ? equal_arc_lengths(scene.length, default_samples)
                                          : all_on_rod(arc_lengths, scene.length);
  Solution solution;
  solution.model = model;
  solution.status = equilibrium.status;
  solution.message = equilibrium.message;
  solution.penetration = equilibrium.penetration;
  solution.error_estimate = equilibrium.error_estimate * scene.length;
  const energy_model::Samples shape = equilibrium.sample(samples);
  solution.shape = {samples, shape.points};
  solution.d1 = shape.d1;
  solution.energy = equilibrium.energy;
  solution.grippers = equilibrium.grips;
  solution.obstacles = expand_obstacle_forces(scene, obstacles, equilibrium.obstacles);
  solution.twists = equilibrium.twists;
  solution.linking = linking_of(scene, equilibrium);
  if (scene.prescribes_twist() && solution.twists.empty()) solution.neglected = {"twist"};
  if (has_friction_contact(scene, solution.obstacles)) solution.neglected.emplace_back("friction");
  solution.contacts = equilibrium.contacts;
  for (energy_model::ContactPart& contact : solution.contacts) {
    contact.obstacle = obstacles[contact.obstacle];
  }
  const std::vector<Eigen::Vector3d> of_shape = shape_loads_before(scene, equilibrium, samples);
  const bool deforms = touches_yielding_obstacle(scene, solution.obstacles);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    solution.curvature.push_back(shape.curvature.col(column).norm());
    if (deforms) continue;
    const Eigen::Vector3d force = section_force(scene, solution, samples[i], of_shape[i]);
    // Adding zero replaces -0 by 0.
    solution.tension.push_back(force.dot(shape.tangents.col(column)) + 0.0);
  }
  solution.smallest_eigenvalue = equilibrium.smallest_eigenvalue;
  solution.stable_energies = equilibrium.stable_energies;
  solution.other_side_starts = equilibrium.other_side_starts;
  solution.neutral_directions = equilibrium.neutral_directions;
  solution.evaluations = equilibrium.evaluations;
  solution.terms = equilibrium.terms;
  solution.seconds = equilibrium.seconds;
  return solution;
}

Solution solve(const Scene& scene, Model model, const SolveOptions& options,
               const std::vector<double>& arc_lengths) {
  if (model == Model::energy || model == Model::exact) {
    return solution_with_stretch_effect(decide_stretch(scene, model, options), model, arc_lengths);
  }
  Solution solution = model == Model::chain ? solve_chain(scene, scene.force_model, options)
                                            : solve_force(scene, scene.force_model, options);
  solution.curvature = joint_curvatures(solution.shape);
  if (!arc_lengths.empty()) {
    const std::vector<double> s = all_on_rod(arc_lengths, scene.length);
    solution.curvature = interpolated(solution.curvature, solution.shape.arc_length, s);
    solution.shape = resample(solution.shape, s);
  }
  return solution;
}

Solution solve_near(const Scene& scene, const MeasuredShape& shape, const SolveOptions& options,
                    const std::vector<double>& arc_lengths) {
  const ArcLengths rule = arc_length_rule(shape, ArcLengths::automatic);
  const energy_model::Equilibrium near =
      reference_near(scene, aligned_by_grippers(shape, scene, rule), options);
  using energy_model::SolveStatus;
  const bool shown = near.status == SolveStatus::saddle ||
                     near.status == SolveStatus::near_singular ||
                     near.status == SolveStatus::not_verified;
  if (!succeeded(near.status) && !(shown && options.accept_unverified)) {
    throw ConvergenceError(
        fmt::format("{}: the energy model found no equilibrium near {}: {} ({} evaluations)",
                    scene.file, shape.file, near.message, near.evaluations));
  }
  return solution_with_stretch_effect(with_stretch_effect(scene, Model::energy, near, options),
                                      Model::energy, arc_lengths);
}

AllSolutions solve_all(const Scene& scene, const SolveOptions& options,
                       const std::vector<double>& arc_lengths) {
  energy_model::EnergySearch search = search_states(scene, options);
  AllSolutions all;
  all.strategies = std::move(search.strategies);
  all.omitted = std::move(search.omitted);
  for (const energy_model::Equilibrium& state : search.equilibria) {
    all.solutions.push_back(solution_with_stretch_effect(
        with_stretch_effect(scene, Model::energy, state, options), Model::energy, arc_lengths));
  }
  return all;
}

}  // namespace dlo::compare
