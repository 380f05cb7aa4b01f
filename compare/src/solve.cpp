#include "dlo/compare/solve.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "chain_start.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/plan.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"

namespace dlo::compare {
namespace {

/// Zero for each obstacle that was left out.
void spread_obstacle_forces(Solution& solution, const std::vector<bool>& in_reach) {
  std::vector<Eigen::Vector3d> forces;
  std::size_t next = 0;
  for (const bool solved : in_reach) {
    const bool known = solved && next < solution.obstacles.size();
    forces.emplace_back(known ? solution.obstacles[next++] : Eigen::Vector3d::Zero());
  }
  solution.obstacles = std::move(forces);
}

/// The exact model's scenes, said in the scene's own words.
void require_exact_scene(const Scene& scene) {
  if (scene.obstacles.empty()) return;
  throw InputError(fmt::format(
      "{}: obstacle: {} given (allowed for model exact: none; --model energy, chain or force takes "
      "them)",
      scene.file, scene.obstacles.size()));
}

/// What a solver does not take, said of the scene's rod instead of the solver's function.
[[noreturn]] void refuse_rod(const Scene& scene, Model model, const std::invalid_argument& error) {
  const std::string_view message = error.what();
  const std::size_t function = message.find(": ");
  throw InputError(
      fmt::format("{}: rod: model {}: {}", scene.file, to_string(model),
                  message.substr(function == std::string_view::npos ? 0 : function + 2)));
}

/// What the part of the rod beyond `at` pulls the part before it with: the opposite of all that
/// acts on the part before.
Eigen::Vector3d section_force(const Scene& scene, const std::vector<GripperLoad>& grippers,
                              double at) {
  const auto before = [&](double s) { return s < at || (s == at && at < scene.length); };
  Eigen::Vector3d sum = at * scene.weight_per_length();
  for (std::size_t i = 0; i < grippers.size(); ++i) {
    if (before(scene.grippers[i].at)) sum += grippers[i].force;
  }
  for (const PointLoad& load : scene.loads) {
    if (before(load.at)) sum += load.force;
  }
  return -sum;
}

/// What came of the searches for equilibria, for a message.
std::string looked_from(const std::vector<energy_model::Equilibrium>& searches) {
  if (searches.empty()) return "no start to look from";
  return fmt::format("{} search{}, the first: {} after {} evaluations", searches.size(),
                     searches.size() == 1 ? "" : "es", searches.front().message,
                     searches.front().evaluations);
}

Solution sampled(const Scene& scene, Model model, const energy_model::Equilibrium& equilibrium,
                 const std::vector<double>& arc_lengths) {
  constexpr int default_samples = 101;
  const std::vector<double> samples =
      arc_lengths.empty() ? equal_arc_lengths(scene.length, default_samples) : arc_lengths;
  Solution solution;
  solution.model = model;
  solution.status = equilibrium.status;
  solution.message = equilibrium.message;
  solution.penetration = equilibrium.penetration;
  const energy_model::Samples shape = equilibrium.sample(samples);
  solution.shape = {samples, shape.points};
  solution.energy = {.bending = equilibrium.energy.bending,
                     .gravity = equilibrium.energy.gravity,
                     .load = equilibrium.energy.load};
  for (const energy_model::Reaction& reaction : equilibrium.grips) {
    solution.grippers.push_back({reaction.force, reaction.torque});
  }
  solution.obstacles = equilibrium.walls;
  const bool touches = std::any_of(equilibrium.walls.begin(), equilibrium.walls.end(),
                                   [](const Eigen::Vector3d& force) { return force.norm() > 0; });
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    solution.curvature.push_back(shape.curvature.col(column).norm());
    if (touches) continue;
    const Eigen::Vector3d force = section_force(scene, solution.grippers, samples[i]);
    // Adding zero turns -0 into 0.
    solution.tension.push_back(force.dot(shape.tangents.col(column)) + 0.0);
  }
  solution.smallest_curvature = equilibrium.smallest_curvature;
  solution.evaluations = equilibrium.evaluations;
  solution.terms = equilibrium.terms;
  solution.seconds = equilibrium.seconds;
  return solution;
}

/// Whether a shape may be handed on: proven, or unproven and asked for.
bool acceptable(energy_model::SolveStatus status, const SolveOptions& options) {
  return energy_model::succeeded(status) ||
         (options.accept_unresolved && status == energy_model::SolveStatus::not_resolved);
}

/// A search among obstacles once more, from the chain's shape. Of two failures the one with a shape
/// that can be shown stays.
void try_from_chain(const Scene& scene, const SolveOptions& options,
                    energy_model::Equilibrium& result) {
  energy_model::Equilibrium other;
  try {
    other = solve_from_chain(scene, options);
  } catch (const ConvergenceError&) {
    return;
  } catch (const InputError&) {
    return;
  }
  const int spent = result.evaluations + other.evaluations;
  const double seconds = result.seconds + other.seconds;
  const bool shows = other.status == energy_model::SolveStatus::not_resolved &&
                     result.status != energy_model::SolveStatus::not_resolved;
  if (energy_model::succeeded(other.status) || shows) result = std::move(other);
  result.evaluations = spent;
  result.seconds = seconds;
}

}  // namespace

energy_model::Equilibrium solve_reference(const Scene& scene, Model model,
                                          const SolveOptions& options) {
  if (model == Model::exact) require_exact_scene(scene);
  const energy_model::Problem problem = energy_problem(scene);
  energy_model::Equilibrium result;
  try {
    result = model == Model::exact
                 ? energy_model::solve_exact(problem, {.time_limit = options.time_limit})
                 : energy_model::solve_energy(problem, {.terms = options.terms,
                                                        .max_evaluations = options.max_evaluations,
                                                        .time_limit = options.time_limit,
                                                        .start = options.start});
    const bool searched = model == Model::energy && options.start == nullptr;
    SolveOptions rest = options;
    rest.time_limit = std::max(options.time_limit - result.seconds, options.time_limit / 4);
    if (!energy_model::succeeded(result.status) && searched && !scene.obstacles.empty()) {
      try_from_chain(scene, rest, result);
    }
  } catch (const std::invalid_argument& error) {
    refuse_rod(scene, model, error);
  }
  if (!acceptable(result.status, options)) {
    throw ConvergenceError(fmt::format(
        "{}: the {} model did not converge: {} ({} evaluations{}{})", scene.file, to_string(model),
        result.message, result.evaluations,
        result.status == energy_model::SolveStatus::time_limit
            ? fmt::format("; --time-limit {:g} allows no more", options.time_limit)
            : "",
        scene.obstacles.empty() ? "" : "; --model chain or an obstacle with a stiffness may do"));
  }
  return result;
}

Solution solve(const Scene& scene, Model model, const SolveOptions& options,
               const std::vector<double>& arc_lengths) {
  const ReachedScene reached = without_far_obstacles(scene);
  const Scene& near = reached.scene;
  Solution solution;
  if (model == Model::chain || model == Model::force) {
    solution = model == Model::chain ? solve_chain(near, near.force_model, options)
                                     : solve_force(near, near.force_model, options);
    solution.curvature = joint_curvatures(solution.shape);
    if (!arc_lengths.empty()) {
      solution.curvature = interpolated(solution.curvature, solution.shape.arc_length, arc_lengths);
      solution.shape = resample(solution.shape, arc_lengths);
    }
  } else {
    solution = sampled(near, model, solve_reference(near, model, options), arc_lengths);
  }
  spread_obstacle_forces(solution, reached.in_reach);
  return solution;
}

std::vector<energy_model::Equilibrium> reference_states(const Scene& scene,
                                                        const SolveOptions& options) {
  std::vector<energy_model::Equilibrium> states;
  try {
    states =
        energy_model::all_energy(energy_problem(scene), {.terms = options.terms,
                                                         .max_evaluations = options.max_evaluations,
                                                         .time_limit = options.time_limit});
  } catch (const std::invalid_argument& error) {
    refuse_rod(scene, Model::energy, error);
  }
  const std::string looked = looked_from(states);
  std::erase_if(states, [&](const energy_model::Equilibrium& state) {
    return !acceptable(state.status, options) && state.status != energy_model::SolveStatus::saddle;
  });
  if (states.empty()) {
    throw ConvergenceError(
        fmt::format("{}: the energy model found no equilibrium ({})", scene.file, looked));
  }
  return states;
}

std::vector<Solution> solve_all(const Scene& scene, const SolveOptions& options,
                                const std::vector<double>& arc_lengths) {
  const ReachedScene reached = without_far_obstacles(scene);
  std::vector<Solution> solutions;
  for (const energy_model::Equilibrium& state : reference_states(reached.scene, options)) {
    solutions.push_back(sampled(scene, Model::energy, state, arc_lengths));
    spread_obstacle_forces(solutions.back(), reached.in_reach);
  }
  return solutions;
}

}  // namespace dlo::compare
