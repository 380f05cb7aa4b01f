#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/solve.hpp"
#include "dlo/force_model/simulation.hpp"
#include "dlo/force_model/tangent_stiffness.hpp"

namespace dlo::compare {
namespace {

/// Shape and energies of a polygon, and what obstacles do to it. Points that a gripper holds do not
/// touch them: a clamp near an obstacle may hold its inner point behind it.
Solution polygon_solution(const Discretisation& discretisation, const Eigen::Matrix3Xd& points) {
  const force_model::Rod& rod = discretisation.rod;
  const force_model::RodEnergy inner = force_model::energy(rod, points);
  const Eigen::Matrix3Xd offset = points.colwise() - rod.grips.front().reference;
  Solution solution;
  solution.shape = discretisation.shape(points);
  solution.parameters = discretisation.parameters;
  SceneEnergies& energy = solution.energy;
  energy.bending = inner.bending;
  energy.stretch = inner.stretch;
  energy.gravity = -discretisation.weights.cwiseProduct(offset).sum();
  energy.load = -(rod.loads - discretisation.weights).cwiseProduct(offset).sum();
  std::vector<bool> held(static_cast<std::size_t>(points.cols()), false);
  for (const force_model::Grip& grip : rod.grips) {
    std::fill_n(held.begin() + grip.first_point, grip.targets.cols(), true);
  }
  for (const force_model::Wall& wall : rod.walls) {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      if (held[static_cast<std::size_t>(i)]) continue;
      force += force_model::wall_force(wall, points.col(i));
      energy.contact += force_model::wall_energy(wall, points.col(i));
    }
    solution.obstacles.push_back(force);
  }
  return solution;
}

/// The segment that differs most from its rest length.
struct Strain {
  Eigen::Index segment = 0;
  double share = 0;  // of its rest length, positive where longer
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

/// A polygon that had to stretch or to shrink is no shape of the rod, however well it balances.
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

Solution solve_rigid_chain(const Scene& scene, const Discretisation& discretisation,
                           const ChainScene& chain, const SolveOptions& options) {
  energy_model::ChainOptions chain_options;
  chain_options.max_evaluations = options.max_evaluations;
  chain_options.time_limit = options.time_limit;
  const energy_model::ChainResult result = energy_model::solve_chain(chain.problem, chain_options);
  if (!energy_model::succeeded(result.status)) {
    throw ConvergenceError(fmt::format("{}: the chain model did not converge: {} ({} evaluations)",
                                       scene.file, result.message, result.evaluations));
  }
  Eigen::Matrix3Xd points = chain.to_space(result.points);
  if (discretisation.rod.grips.front().first_point != 0) {
    points = points.rowwise().reverse().eval();
  }
  Solution solution = polygon_solution(discretisation, points);
  solution.status = result.status;
  solution.message = result.message;
  solution.grippers = {balancing_load(discretisation, points)};
  solution.evaluations = result.evaluations;
  solution.seconds = result.seconds;
  return solution;
}

/// What is left of a limit of time [s].
class TimeLeft {
 public:
  explicit TimeLeft(double seconds) : seconds_(seconds) {}

  [[nodiscard]] double now() const {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin_;
    return seconds_ - spent.count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double seconds_;
};

/// The lowest of the shapes that a polygon's starts lead to.
struct LowestPolygon {
  std::size_t start = 0;  ///< of Discretisation::starts
  energy_model::PolygonResult result;
  int evaluations = 0;  ///< of all starts
  double seconds = 0;
};

LowestPolygon lowest_polygon(const Scene& scene, const ForceModelSettings& settings,
                             const Discretisation& discretisation, const SolveOptions& options) {
  const energy_model::PolygonProblem problem = polygon_problem(discretisation.rod);
  const double allowed = largest_strain(scene, settings);
  const TimeLeft left(options.time_limit);
  energy_model::PolygonOptions polygon_options;
  polygon_options.max_evaluations = options.max_evaluations;
  LowestPolygon lowest;
  bool lowest_is_shape = false;
  for (std::size_t i = 0; i < discretisation.starts.size(); ++i) {
    polygon_options.time_limit = left.now();
    if (i > 0 && polygon_options.time_limit <= 0) break;
    energy_model::PolygonResult result =
        energy_model::solve_polygon(problem, discretisation.starts[i], polygon_options);
    lowest.evaluations += result.evaluations;
    lowest.seconds += result.seconds;
    // Mirror images have the same energy but for rounding; the first start keeps them.
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
  return lowest;
}

Solution solve_elastic_chain(const Scene& scene, const ForceModelSettings& settings,
                             const Discretisation& discretisation, const SolveOptions& options) {
  const LowestPolygon lowest = lowest_polygon(scene, settings, discretisation, options);
  const Eigen::Matrix3Xd& points = lowest.result.points;
  Solution solution = polygon_solution(discretisation, points);
  solution.status = lowest.result.status;
  solution.message = lowest.result.message;
  Eigen::Index next = 0;  // grip_forces are in the order of the grips' points
  for (const force_model::Grip& grip : discretisation.rod.grips) {
    GripperLoad load;
    for (Eigen::Index k = 0; k < grip.targets.cols(); ++k) {
      const Eigen::Vector3d force = lowest.result.grip_forces.col(next++);
      const Eigen::Vector3d arm = points.col(grip.first_point + k) - grip.reference;
      load.force += force;
      load.torque += arm.cross(force);
    }
    solution.grippers.push_back(load);
  }
  solution.evaluations = lowest.evaluations;
  solution.seconds = lowest.seconds;
  return solution;
}

/// Where a simulation starts, and where it should come to rest.
struct SimulationStart {
  Eigen::Matrix3Xd points;
  std::optional<Eigen::Matrix3Xd> rest;  // of the chain, where there are several states
};

/// Of several starts it is the one from which the chain comes lowest, since the two are to be
/// compared in the same state; and it is moved by a thousandth of the way to the chain's shape, for
/// starts are as symmetric as their scene and may lead to a saddle, on which a simulation would
/// balance.
SimulationStart simulation_start(const Scene& scene, const ForceModelSettings& settings,
                                 const Discretisation& discretisation,
                                 const SolveOptions& options) {
  if (discretisation.starts.size() == 1) return {discretisation.starts.front(), std::nullopt};
  constexpr double nudge = 1e-3;
  LowestPolygon lowest = lowest_polygon(scene, settings, discretisation, options);
  const Eigen::Matrix3Xd& start = discretisation.starts[lowest.start];
  return {start + nudge * (lowest.result.points - start), std::move(lowest.result.points)};
}

/// Whether a simulation has come to rest elsewhere than the chain, by more than the laws differ.
bool in_another_state(const Scene& scene, const Discretisation& discretisation,
                      const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& rest) {
  constexpr double apart = 0.01;
  return rms(discretisation.arc_length, points - rest) > apart * scene.length;
}

}  // namespace

Solution solve_chain(const Scene& scene, const ForceModelSettings& settings,
                     const SolveOptions& options) {
  const Discretisation discretisation = discretise(scene, settings);
  const std::optional<ChainScene> chain = chain_scene(scene, discretisation, settings);
  Solution solution = chain ? solve_rigid_chain(scene, discretisation, *chain, options)
                            : solve_elastic_chain(scene, settings, discretisation, options);
  solution.model = Model::chain;
  return solution;
}

Shape chain_from(const Scene& scene, const ForceModelSettings& settings, const Shape& start,
                 const SolveOptions& options) {
  const Discretisation discretisation = discretise(scene, settings);
  energy_model::PolygonOptions polygon_options;
  polygon_options.max_evaluations = options.max_evaluations;
  polygon_options.time_limit = options.time_limit;
  const energy_model::PolygonResult result = energy_model::solve_polygon(
      polygon_problem(discretisation.rod), resample(start, discretisation.arc_length).points,
      polygon_options);
  if (!energy_model::succeeded(result.status)) {
    throw ConvergenceError(fmt::format("{}: the chain model did not converge: {} ({} evaluations)",
                                       scene.file, result.message, result.evaluations));
  }
  require_unstrained(scene, settings, discretisation, result.points, "chain");
  return discretisation.shape(result.points);
}

Solution solve_force(const Scene& scene, const ForceModelSettings& settings,
                     const SolveOptions& options) {
  const Discretisation discretisation = discretise(scene, settings);
  const SimulationStart start = simulation_start(scene, settings, discretisation, options);
  const auto begin = std::chrono::steady_clock::now();
  const auto simulation_from = [&](const Eigen::Matrix3Xd& points) {
    try {
      return force_model::Simulation(discretisation.rod, points,
                                     step_options(settings, discretisation));
    } catch (const std::invalid_argument& error) {
      throw InputError(fmt::format("{}: the force model: {}", scene.file, error.what()));
    }
  };
  const force_model::RelaxOptions limits{.tolerance = options.rest_tolerance,
                                         .max_steps = options.max_steps,
                                         .time_limit = options.time_limit};
  force_model::Simulation simulation = simulation_from(start.points);
  force_model::RelaxResult result = simulation.relax(limits);
  const auto strayed = [&] {
    return result.status == force_model::RelaxStatus::at_rest && start.rest &&
           in_another_state(scene, discretisation, simulation.points(), *start.rest);
  };
  if (strayed()) {
    // It has swung past the chain's state; from a tenth of the way before it it cannot.
    constexpr double near = 0.9;
    const long steps = result.steps;
    simulation = simulation_from(start.points + near * (*start.rest - start.points));
    result = simulation.relax(limits);
    result.steps += steps;
  }
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
  require_unstrained(scene, settings, discretisation, simulation.points(), "force");
  Solution solution = polygon_solution(discretisation, simulation.points());
  solution.model = Model::force;
  solution.message = result.message;
  if (strayed()) solution.message += ", in another state than the chain";
  // What an obstacle does to a held point inside a gripper is not felt outside.
  force_model::Rod without_walls = simulation.rod();
  without_walls.walls.clear();
  for (const force_model::GripReaction& reaction :
       force_model::grip_reactions(without_walls, simulation.points())) {
    solution.grippers.push_back({reaction.force, reaction.torque});
  }
  solution.steps = result.steps;
  solution.c_F = simulation.options().c_F;
  solution.c_h = simulation.options().c_h;
  solution.remaining_error = result.remaining_error;
  solution.to_rest = force_model::check_equilibrium(simulation.rod(), simulation.points()).step;
  solution.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return solution;
}

}  // namespace dlo::compare
