#include "dlo/compare/force.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/timer.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/energy_model/interrupt.hpp"
#include "dlo/force_model/simulation.hpp"
#include "dlo/force_model/tangent_stiffness.hpp"
#include "polygon/natural_plane.hpp"
#include "polygon/point_layout.hpp"
#include "polygon/shape_loads.hpp"
#include "solve/polygon_solution.hpp"
#include "solve/states.hpp"

namespace dlo::compare {
namespace {

/// Fraction of the displacement from the start to the chain's shape at which a simulation starts.
/// It is then close enough not to move beyond that shape.
constexpr double start_fraction = 0.9;

/// Initial state of a simulation, and the shape at which it should come to rest.
struct SimulationStart {
  force_model::Rod rod;
  Eigen::Matrix3Xd points;
  std::optional<Eigen::Matrix3Xd> rest;  // shape of the chain, if there are several starts
};

/// Returns the start of a simulation. Of several starts it is the one from which the chain has the
/// lowest energy, because the two models are to be compared in the same equilibrium. The start is
/// moved by a thousandth of the displacement to the chain's shape: a start has the symmetry of its
/// scene, so that a simulation could stay at a saddle. A rod that clamps twist starts near the
/// chain's shape, which was found by small steps of twist; with the whole twist at once the
/// simulation could converge to another equilibrium.
SimulationStart simulation_start(const Scene& scene, const ForceModelSettings& settings,
                                 const Discretisation& discretisation,
                                 const SolveOptions& options) {
  if (discretisation.starts.size() == 1) {
    return {discretisation.rod, discretisation.starts.front(), std::nullopt};
  }
  constexpr double perturbation = 1e-3;
  LowestPolygon lowest = lowest_polygon(scene, settings, discretisation, options);
  const Eigen::Matrix3Xd& rest = lowest.result.points;
  Eigen::Matrix3Xd points;
  if (models_twist(scene, settings)) {
    points = lowest.untwisted + start_fraction * (rest - lowest.untwisted);
  } else {
    const Eigen::Matrix3Xd& start = discretisation.starts[lowest.start];
    points = start + perturbation * (rest - start);
  }
  return {std::move(lowest.rod), std::move(points), std::move(lowest.result.points)};
}

using Simulate = std::function<force_model::Simulation(const force_model::Rod& rod,
                                                       const Eigen::Matrix3Xd& points)>;

/// A simulation that has come to rest, and how it did.
struct RelaxedRod {
  force_model::Simulation simulation;
  force_model::RelaxResult result;
};

/// Anderson acceleration of a fixed-point iteration (type II; Walker and Ni 2011): combines the
/// last values with the coefficients that minimise the combined residual.
class FixedPoint {
 public:
  /// Returns the next iterate. @param g  value of the fixed-point function at x
  Eigen::VectorXd next(const Eigen::VectorXd& x, const Eigen::VectorXd& g) {
    constexpr Eigen::Index most_kept = 8;
    const Eigen::VectorXd f = g - x;
    if (f_.size() == 0) {
      residuals_.resize(f.size(), 0);
      values_.resize(f.size(), 0);
    } else {
      const Eigen::Index kept = std::min(residuals_.cols(), most_kept - 1);
      Eigen::MatrixXd residuals(f.size(), kept + 1);
      Eigen::MatrixXd values(f.size(), kept + 1);
      residuals << residuals_.rightCols(kept), f - f_;
      values << values_.rightCols(kept), g - g_;
      residuals_ = std::move(residuals);
      values_ = std::move(values);
    }
    f_ = f;
    g_ = g;
    if (residuals_.cols() == 0) return g;
    const Eigen::VectorXd shares = residuals_.colPivHouseholderQr().solve(f);
    return g - values_ * shares;
  }

 private:
  Eigen::VectorXd f_;
  Eigen::VectorXd g_;
  Eigen::MatrixXd residuals_;  // changes of f = g - x, one per column
  Eigen::MatrixXd values_;     // changes of g, one per column
};

/// A rod under drag: the rod without the drag, and how it is relaxed.
struct DragProblem {
  const Scene& scene;
  const std::vector<double>& arc_length;
  const force_model::Rod& dead;
  const force_model::RelaxOptions& limits;
  const Simulate& simulate;
};

/// Finds the shape at rest under a share of the drag. The drag is frozen on a shape while the
/// polygon comes to rest; a fixed-point iteration finds the shape that is its own rest.
/// @param moves  displacement below which the iteration has converged [m]
/// @param[in,out] steps  number of steps, added to
/// @return std::nullopt if the iteration does not converge, or a simulation does not come to rest
std::optional<RelaxedRod> relax_under_drag(const DragProblem& dragged, double share,
                                           const Eigen::Matrix3Xd& begin, double moves,
                                           long& steps) {
  constexpr int most_rounds = 25;
  // A larger displacement may lead to another branch.
  const double largest_movement = 0.25 * dragged.scene.length;
  FixedPoint search;
  Eigen::Matrix3Xd shape = begin;  // on which the drag is frozen
  Eigen::Matrix3Xd rest = begin;
  for (int round = 0; round < most_rounds; ++round) {
    force_model::Rod rod = dragged.dead;
    rod.loads += share * drag_forces(dragged.scene, dragged.arc_length, shape);
    force_model::Simulation simulation = dragged.simulate(rod, rest);
    const force_model::RelaxResult result = simulation.relax(dragged.limits);
    steps += result.steps;
    if (result.status != force_model::RelaxStatus::at_rest) return std::nullopt;
    rest = simulation.points();
    const double moved = (rest - shape).colwise().norm().maxCoeff();
    if (moved < moves) return RelaxedRod{std::move(simulation), result};
    if (moved > largest_movement) return std::nullopt;
    const Eigen::VectorXd next = search.next(shape.reshaped(), rest.reshaped());
    shape = next.reshaped(3, rest.cols());
  }
  return std::nullopt;
}

/// Continues the shape at rest without drag to the one under the full drag, by growing shares of
/// the drag.
/// @param points  shape at rest without drag [m]
/// @throws ConvergenceError if the share cannot grow to 1
RelaxedRod continue_to_full_drag(const DragProblem& dragged, Eigen::Matrix3Xd points) {
  constexpr double first_share = 0.25;
  constexpr double least_share = 0.02;  // a shorter step of the share ends the continuation
  constexpr double partial_tolerance =
      1e-3;  // tolerance before the full drag, divided by the length
  const double final_tolerance = 10 * dragged.limits.tolerance;
  double reached = 0;
  long steps = 0;
  for (double step = first_share; step > least_share;) {
    const double share = std::min(1.0, reached + step);
    std::optional<RelaxedRod> rest = relax_under_drag(
        dragged, share, points,
        (share < 1 ? partial_tolerance : final_tolerance) * dragged.scene.length, steps);
    if (!rest) {
      step /= 2;
      continue;
    }
    if (share == 1) {
      rest->result.steps = steps;
      rest->result.message +=
          ", an equilibrium whose stability is not judged: drag has no potential";
      return *std::move(rest);
    }
    points = rest->simulation.points();
    reached = share;
    step *= 1.5;
  }
  throw ConvergenceError(
      fmt::format("{}: the force model did not come to rest under more than {:.2g} of the drag "
                  "(--model exact may do)",
                  dragged.scene.file, reached));
}

std::string not_at_rest_message(const Scene& scene, const ForceModelSettings& settings,
                                const Discretisation& discretisation, const RelaxedRod& moving) {
  return fmt::format(
      "{}: the force model did not come to rest: {} after {} steps, about {:.2g} m from it "
      "(stepper {}, c_F = {:.4g} m/N, c_c = {:.4g} N{})",
      scene.file, moving.result.message, moving.result.steps, moving.result.remaining_error,
      to_string(settings.stepper), moving.simulation.options().c_F, discretisation.parameters.c_c,
      settings.stepper == Stepper::automatic || settings.stepper == Stepper::implicit
          ? ""
          : "; stepper auto chooses its constants, a lower c_c lets the others take larger "
            "steps");
}

void add_relax_result(const RelaxedRod& rest, Solution& solution) {
  const force_model::Simulation& simulation = rest.simulation;
  solution.model = Model::force;
  solution.message = rest.result.message;
  solution.steps = rest.result.steps;
  solution.c_F = simulation.options().c_F;
  solution.c_h = simulation.options().c_h;
  solution.error_estimate = rest.result.remaining_error;
  solution.to_rest = force_model::check_equilibrium(simulation.rod(), simulation.points()).step;
}

}  // namespace

Solution solve_force(const Scene& scene, const ForceModelSettings& settings,
                     const SolveOptions& options) {
  if (const std::optional<PlaneTransform> turn = plane_transform(scene, settings)) {
    return solution_in_space(solve_force(turn->transformed(scene), settings, options), *turn);
  }
  const bool is_dragged = scene.drag && scene.drag->largest() > 0;
  Scene dead_scene = scene;
  dead_scene.drag.reset();
  Discretisation discretisation = discretise(dead_scene, settings);
  set_masses(dead_scene, settings, discretisation);
  const SimulationStart start = simulation_start(dead_scene, settings, discretisation, options);
  const Timer timer;
  const auto simulate = [&](const force_model::Rod& rod, const Eigen::Matrix3Xd& points) {
    try {
      return force_model::Simulation(rod, points, step_options(settings, discretisation));
    } catch (const std::invalid_argument& error) {
      throw InputError(fmt::format("{}: the force model: {}", dead_scene.file, error.what()));
    }
  };
  const force_model::RelaxOptions limits{.tolerance = options.rest_tolerance,
                                         .max_steps = options.max_steps,
                                         .time_limit = options.time_limit,
                                         .interrupted = energy_model::interrupted};
  RelaxedRod rest{simulate(start.rod, start.points), {}};
  rest.result = rest.simulation.relax(limits);
  // The simulation may come to rest farther from the chain's shape than the difference between the
  // two laws explains.
  const auto has_switched = [&] {
    constexpr double least_difference = 0.01;
    return rest.result.status == force_model::RelaxStatus::at_rest && start.rest &&
           rms(discretisation.arc_length, rest.simulation.points() - *start.rest) >
               least_difference * scene.length;
  };
  if (has_switched()) {
    // The simulation went past the chain's equilibrium. It does not if it starts nine tenths of the
    // way to it.
    const long steps = rest.result.steps;
    rest.simulation =
        simulate(start.rod, start.points + start_fraction * (*start.rest - start.points));
    rest.result = rest.simulation.relax(limits);
    rest.result.steps += steps;
  }
  if (rest.result.status != force_model::RelaxStatus::at_rest) {
    throw ConvergenceError(not_at_rest_message(dead_scene, settings, discretisation, rest));
  }
  const Eigen::Matrix3Xd dead_loads = rest.simulation.rod().loads;
  if (is_dragged) {
    const long steps = rest.result.steps;
    rest = continue_to_full_drag(
        {scene, discretisation.arc_length, rest.simulation.rod(), limits, simulate},
        rest.simulation.points());
    rest.result.steps += steps;
  }
  require_unstrained(dead_scene, settings, discretisation, rest.simulation.points(), "force");
  force_model::Rod rod = rest.simulation.rod();
  rod.loads = dead_loads;  // drag has no energy
  Solution solution =
      polygon_solution(dead_scene, settings, discretisation, rod, rest.simulation.points());
  add_relax_result(rest, solution);
  const force_model::Rod& resting = rest.simulation.rod();
  const Eigen::Matrix3Xd& points = rest.simulation.points();
  // Newton's step to rest bounds the imbalance only near rest, and not with the paper's law, whose
  // straight joints have no stiffness.
  constexpr double near_rest = 1e-6;  // divided by the length
  const bool is_bounded =
      settings.law == BendingLaw::hooke && solution.error_estimate <= near_rest * scene.length;
  const double allowed = is_bounded ? allowed_rest_imbalance(resting, points, solution.to_rest)
                                    : std::numeric_limits<double>::infinity();
  BalancedGrippers balance =
      balanced(scene, resting, points, gripper_loads(resting, points), allowed, "force");
  solution.grippers = std::move(balance.loads);
  constexpr double reported_imbalance_limit = 1e-6;  // divided by the largest force or moment
  if (balance.share > reported_imbalance_limit) {
    solution.message += fmt::format(
        ", forces and moments are balanced within {:.2g} of the largest", balance.share);
  }
  if (is_dragged) solution.status = energy_model::SolveStatus::not_verified;
  if (!is_dragged && has_switched()) solution.message += ", in another state than the chain";
  solution.seconds = timer.seconds();
  return solution;
}

}  // namespace dlo::compare
