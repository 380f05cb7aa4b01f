#include "dlo/compare/force.hpp"

#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <stdexcept>
#include <utility>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/energy_model/interrupt.hpp"
#include "dlo/force_model/simulation.hpp"
#include "dlo/force_model/tangent_stiffness.hpp"
#include "polygon/natural_plane.hpp"
#include "polygon/step_constants.hpp"
#include "solve/polygon_solution.hpp"
#include "solve/turned_solution.hpp"

namespace dlo::compare {
namespace {

/// Of the way to the chain's shape, from where a simulation cannot swing past it.
constexpr double nearly_there = 0.9;

/// Where a simulation starts, and where it should come to rest.
struct SimulationStart {
  force_model::Rod rod;
  Eigen::Matrix3Xd points;
  std::optional<Eigen::Matrix3Xd> rest;  // of the chain, where there are several states
};

/// Of several starts it is the one from which the chain comes lowest, since the two are to be
/// compared in the same state; and it is moved by a thousandth of the way to the chain's shape, for
/// starts are as symmetric as their scene and may lead to a saddle, on which a simulation would
/// balance. A rod that clamps twist starts near the chain's shape: it has been twisted there little
/// by little, and all at once could lead elsewhere.
SimulationStart simulation_start(const Scene& scene, const ForceModelSettings& settings,
                                 const Discretisation& discretisation,
                                 const SolveOptions& options) {
  if (discretisation.starts.size() == 1) {
    return {discretisation.rod, discretisation.starts.front(), std::nullopt};
  }
  constexpr double nudge = 1e-3;
  LowestPolygon lowest = lowest_polygon(scene, settings, discretisation, options);
  const Eigen::Matrix3Xd& rest = lowest.result.points;
  Eigen::Matrix3Xd points;
  if (takes_twist(scene, settings)) {
    points = lowest.untwisted + nearly_there * (rest - lowest.untwisted);
  } else {
    const Eigen::Matrix3Xd& start = discretisation.starts[lowest.start];
    points = start + nudge * (rest - start);
  }
  return {std::move(lowest.rod), std::move(points), std::move(lowest.result.points)};
}

/// Whether a simulation has come to rest elsewhere than the chain, by more than the laws differ.
bool in_another_state(const Scene& scene, const Discretisation& discretisation,
                      const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& rest) {
  constexpr double apart = 0.01;
  return rms(discretisation.arc_length, points - rest) > apart * scene.length;
}

}  // namespace

Solution solve_force(const Scene& scene, const ForceModelSettings& settings,
                     const SolveOptions& options) {
  if (const std::optional<PlaneTurn> turn = turn_into_plane(scene, settings)) {
    return turned_back(solve_force(turn->laid(scene), settings, options), *turn);
  }
  Discretisation discretisation = discretise(scene, settings);
  set_masses(scene, settings, discretisation);
  const SimulationStart start = simulation_start(scene, settings, discretisation, options);
  const auto begin = std::chrono::steady_clock::now();
  const auto simulation_from = [&](const Eigen::Matrix3Xd& points) {
    try {
      return force_model::Simulation(start.rod, points, step_options(settings, discretisation));
    } catch (const std::invalid_argument& error) {
      throw InputError(fmt::format("{}: the force model: {}", scene.file, error.what()));
    }
  };
  const force_model::RelaxOptions limits{.tolerance = options.rest_tolerance,
                                         .max_steps = options.max_steps,
                                         .time_limit = options.time_limit,
                                         .interrupted = energy_model::interrupted};
  force_model::Simulation simulation = simulation_from(start.points);
  force_model::RelaxResult result = simulation.relax(limits);
  const auto strayed = [&] {
    return result.status == force_model::RelaxStatus::at_rest && start.rest &&
           in_another_state(scene, discretisation, simulation.points(), *start.rest);
  };
  if (strayed()) {
    // It has swung past the chain's state; from a tenth of the way before it it cannot.
    const long steps = result.steps;
    simulation = simulation_from(start.points + nearly_there * (*start.rest - start.points));
    result = simulation.relax(limits);
    result.steps += steps;
  }
  if (result.status != force_model::RelaxStatus::at_rest) {
    throw ConvergenceError(fmt::format(
        "{}: the force model did not come to rest: {} after {} steps, about {:.2g} m from it "
        "(stepper {}, c_F = {:.4g} m/N, c_c = {:.4g} N{})",
        scene.file, result.message, result.steps, result.remaining_error,
        to_string(settings.stepper), simulation.options().c_F, discretisation.parameters.c_c,
        settings.stepper == Stepper::automatic || settings.stepper == Stepper::implicit
            ? ""
            : "; stepper auto chooses its constants, a lower c_c lets the others take larger "
              "steps"));
  }
  require_unstrained(scene, settings, discretisation, simulation.points(), "force");
  Solution solution =
      polygon_solution(scene, settings, discretisation, simulation.rod(), simulation.points());
  solution.model = Model::force;
  solution.message = result.message;
  if (strayed()) solution.message += ", in another state than the chain";
  // What an obstacle does to a held point inside a gripper is not felt outside.
  force_model::Rod without_walls = simulation.rod();
  without_walls.walls.clear();
  without_walls.solids.clear();
  for (const force_model::GripReaction& reaction :
       force_model::grip_reactions(without_walls, simulation.points())) {
    solution.grippers.push_back({reaction.force, reaction.torque});
  }
  solution.steps = result.steps;
  solution.c_F = simulation.options().c_F;
  solution.c_h = simulation.options().c_h;
  solution.error_estimate = result.remaining_error;
  solution.to_rest = force_model::check_equilibrium(simulation.rod(), simulation.points()).step;
  solution.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return solution;
}

}  // namespace dlo::compare
