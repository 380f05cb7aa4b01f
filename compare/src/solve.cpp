#include "dlo/compare/solve.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>

#include "dlo/compare/error.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "dlo/force_model/simulation.hpp"

namespace dlo::compare {
namespace {

SceneEnergies polygon_energies(const Discretisation& discretisation,
                               const Eigen::Matrix3Xd& points) {
  const force_model::RodEnergy inner = force_model::energy(discretisation.rod, points);
  const Eigen::Matrix3Xd offset = points.colwise() - discretisation.rod.grips.front().reference;
  SceneEnergies energy;
  energy.bending = inner.bending;
  energy.stretch = inner.stretch;
  energy.contact = inner.contact;
  energy.gravity = -discretisation.weights.cwiseProduct(offset).sum();
  energy.load = -(discretisation.rod.loads - discretisation.weights).cwiseProduct(offset).sum();
  return energy;
}

/// What the gripper of a polygon without stretch exerts: its tension is a constraint, so it follows
/// from the balance of the whole polygon.
GripperLoad balancing_load(const Discretisation& discretisation, const Eigen::Matrix3Xd& points) {
  const Eigen::Vector3d reference = discretisation.rod.grips.front().reference;
  GripperLoad result;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d load = discretisation.rod.loads.col(i);
    const Eigen::Vector3d arm = points.col(i) - reference;
    result.force -= load;
    result.torque -= arm.cross(load);
  }
  return result;
}

/// The exact model's scenes, said in the scene's own words.
void require_exact_scene(const Scene& scene) {
  if (scene.obstacles.empty()) return;
  throw InputError(fmt::format(
      "{}: obstacle: {} given (allowed for model exact: none; model energy takes every scene)",
      scene.file, scene.obstacles.size()));
}

Solution sampled(const Scene& scene, Model model, const energy_model::Equilibrium& equilibrium,
                 const std::vector<double>& arc_lengths) {
  constexpr int default_samples = 101;
  const std::vector<double> samples =
      arc_lengths.empty() ? equal_arc_lengths(scene.length, default_samples) : arc_lengths;
  Solution solution;
  solution.model = model;
  solution.message = equilibrium.message;
  solution.shape = {samples, equilibrium.sample(samples).points};
  solution.energy = {.bending = equilibrium.energy.bending,
                     .gravity = equilibrium.energy.gravity,
                     .load = equilibrium.energy.load};
  for (const energy_model::Reaction& reaction : equilibrium.grips) {
    solution.grippers.push_back({reaction.force, reaction.torque});
  }
  solution.obstacles = equilibrium.walls;
  solution.smallest_curvature = equilibrium.smallest_curvature;
  solution.evaluations = equilibrium.evaluations;
  solution.terms = equilibrium.terms;
  solution.seconds = equilibrium.seconds;
  return solution;
}

}  // namespace

const std::vector<std::string>& model_names() {
  static const std::vector<std::string> names = {"energy", "chain", "exact", "force"};
  return names;
}

const char* to_string(Model model) {
  return model_names()[static_cast<std::size_t>(model)].c_str();
}

Model model_from(const std::string& name) {
  const auto& names = model_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw InputError(
        fmt::format("unknown model \"{}\" (allowed: {})", name, fmt::join(names, ", ")));
  }
  return static_cast<Model>(found - names.begin());
}

energy_model::Equilibrium solve_reference(const Scene& scene, Model model,
                                          const SolveOptions& options) {
  if (model == Model::exact) require_exact_scene(scene);
  const energy_model::Problem problem = energy_problem(scene);
  energy_model::Equilibrium result;
  try {
    result =
        model == Model::exact
            ? energy_model::solve_exact(problem)
            : energy_model::solve_energy(
                  problem, {.terms = options.terms, .max_evaluations = options.max_evaluations});
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", scene.file, error.what()));
  }
  if (!energy_model::succeeded(result.status)) {
    throw ConvergenceError(fmt::format("{}: the {} model did not converge: {} ({} evaluations)",
                                       scene.file, to_string(model), result.message,
                                       result.evaluations));
  }
  return result;
}

Solution solve_chain(const Scene& scene, const ForceModelSettings& settings,
                     const SolveOptions& options) {
  const Discretisation discretisation = discretise(scene, settings);
  const ChainScene chain = chain_scene(scene, discretisation, settings);
  energy_model::ChainOptions chain_options;
  chain_options.max_evaluations = options.max_evaluations;
  const energy_model::ChainResult result = energy_model::solve_chain(chain.problem, chain_options);
  if (!energy_model::succeeded(result.status)) {
    throw ConvergenceError(fmt::format("{}: the chain model did not converge: {} ({} evaluations)",
                                       scene.file, result.message, result.evaluations));
  }
  Eigen::Matrix3Xd points = chain.to_space(result.points);
  if (discretisation.rod.grips.front().first_point != 0) {
    points = points.rowwise().reverse().eval();
  }
  Solution solution;
  solution.model = Model::chain;
  solution.message = result.message;
  solution.shape = discretisation.shape(points);
  solution.energy = polygon_energies(discretisation, points);
  solution.grippers = {balancing_load(discretisation, points)};
  solution.evaluations = result.evaluations;
  solution.seconds = result.seconds;
  solution.parameters = discretisation.parameters;
  return solution;
}

Solution solve_force(const Scene& scene, const ForceModelSettings& settings,
                     const SolveOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  const Discretisation discretisation = discretise(scene, settings);
  const auto simulation_of = [&] {
    try {
      return force_model::Simulation(discretisation.rod, discretisation.straight,
                                     step_options(settings, discretisation));
    } catch (const std::invalid_argument& error) {
      throw InputError(fmt::format("{}: the force model: {}", scene.file, error.what()));
    }
  };
  force_model::Simulation simulation = simulation_of();
  const force_model::RelaxResult result =
      simulation.relax({.tolerance = options.rest_tolerance, .max_steps = options.max_steps});
  if (result.status != force_model::RelaxStatus::at_rest) {
    throw ConvergenceError(fmt::format(
        "{}: the force model did not come to rest: {} after {} steps, about {:.2g} m from it "
        "(stepper {}, c_F = {:.4g} m/N, c_c = {:.4g} N{})",
        scene.file, result.message, result.steps, result.remaining_error,
        to_string(settings.stepper), simulation.options().c_F, discretisation.parameters.c_c,
        settings.stepper == StepperName::automatic
            ? ""
            : "; stepper auto chooses its constants, a lower c_c lets the others take larger "
              "steps"));
  }
  Solution solution;
  solution.model = Model::force;
  solution.message = result.message;
  solution.shape = discretisation.shape(simulation.points());
  solution.energy = polygon_energies(discretisation, simulation.points());
  for (const force_model::GripReaction& reaction :
       force_model::grip_reactions(simulation.rod(), simulation.points())) {
    solution.grippers.push_back({reaction.force, reaction.torque});
  }
  solution.steps = result.steps;
  solution.parameters = discretisation.parameters;
  solution.c_F = simulation.options().c_F;
  solution.c_h = simulation.options().c_h;
  solution.remaining_error = result.remaining_error;
  solution.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return solution;
}

Solution solve(const Scene& scene, Model model, const SolveOptions& options,
               const std::vector<double>& arc_lengths) {
  if (model == Model::chain || model == Model::force) {
    Solution solution = model == Model::chain ? solve_chain(scene, scene.force_model, options)
                                              : solve_force(scene, scene.force_model, options);
    if (!arc_lengths.empty()) solution.shape = resample(solution.shape, arc_lengths);
    return solution;
  }
  return sampled(scene, model, solve_reference(scene, model, options), arc_lengths);
}

std::vector<Solution> solve_all(const Scene& scene, const SolveOptions& options,
                                const std::vector<double>& arc_lengths) {
  std::vector<Solution> solutions;
  try {
    for (const energy_model::Equilibrium& equilibrium : energy_model::all_energy(
             energy_problem(scene),
             {.terms = options.terms, .max_evaluations = options.max_evaluations})) {
      const bool equilibrium_found = energy_model::succeeded(equilibrium.status) ||
                                     equilibrium.status == energy_model::SolveStatus::saddle;
      if (equilibrium_found) {
        solutions.push_back(sampled(scene, Model::energy, equilibrium, arc_lengths));
      }
    }
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", scene.file, error.what()));
  }
  if (solutions.empty()) {
    throw ConvergenceError(fmt::format("{}: the energy model found no equilibrium", scene.file));
  }
  return solutions;
}

}  // namespace dlo::compare
