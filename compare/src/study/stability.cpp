#include "study/stability.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/progress_counter.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/force_model/simulation.hpp"
#include "parallel/threads.hpp"
#include "polygon/energy_problems.hpp"
#include "polygon/point_layout.hpp"
#include "shape/curve.hpp"

namespace dlo::compare {
namespace {

// Shapes sampled during a run, and number of consecutive steps sampled at its end.
constexpr int samples = 64;
constexpr double rest_displacement = 1e-6;  // allowed movement of a rod at rest, in lengths
// Allowed increase of the energy of a rod at rest, divided by the energy: rounding only.
constexpr double rest_energy_growth = 1e-12;

force_model::StepOptions options_for(const HardCase& hard, Stepper stepper) {
  ForceModelSettings settings;
  settings.stepper = stepper;
  return step_options(settings, hard.discretisation);
}

/// Moves the gripper through its motion; returns false if a step diverges.
bool move_gripper(const HardCase& hard, force_model::Simulation& simulation) {
  for (long step = 1; step <= hard.motion.steps; ++step) {
    const double share = static_cast<double>(step) / static_cast<double>(hard.motion.steps);
    const force_model::Rod now = hard.rod(share);
    simulation.move_grip(0, now.grips.front().targets, now.grips.front().reference);
    if (simulation.step().status == force_model::StepStatus::diverged) return false;
  }
  return true;
}

/// Steps the rod until it is at rest or max_steps is reached.
SimulationEnd step_until_rest(force_model::Simulation& simulation, long max_steps) {
  SimulationEnd trajectory{.finite = true};
  const force_model::RelaxOptions part{.tolerance = 1e-6,
                                       .max_steps = std::max(1L, (max_steps - samples) / samples)};
  for (int sample = 0; sample < samples && trajectory.finite && !trajectory.at_rest; ++sample) {
    const force_model::RelaxResult result = simulation.relax(part);
    trajectory.finite = result.status != force_model::RelaxStatus::diverged;
    trajectory.at_rest = result.status == force_model::RelaxStatus::at_rest;
    if (sample >= samples / 2 || trajectory.at_rest)
      trajectory.late_shapes.push_back(simulation.points());
  }
  for (int step = 0; step < samples && trajectory.finite && !trajectory.at_rest; ++step) {
    trajectory.finite = simulation.step().status != force_model::StepStatus::diverged;
    trajectory.last_shapes.push_back(simulation.points());
  }
  if (!trajectory.at_rest) trajectory.late_shapes.push_back(simulation.points());
  return trajectory;
}

/// Makes steps from the rest shape; all sampled shapes are classified.
SimulationEnd step_from_rest(force_model::Simulation& simulation, long steps) {
  SimulationEnd trajectory{.finite = true};
  for (long step = 1; step <= steps && trajectory.finite; ++step) {
    trajectory.finite = simulation.step().status != force_model::StepStatus::diverged;
    if (step % std::max(1L, steps / samples) == 0)
      trajectory.late_shapes.push_back(simulation.points());
  }
  trajectory.late_shapes.push_back(simulation.points());
  return trajectory;
}

energy_model::PolygonResult reference_of(const HardCase& hard) {
  return polygon_at_rest(hard.name, hard.rod(1), hard.moved(hard.discretisation.starts.front(), 1));
}

/// Changes the result to a pass, with a note, if the final shape is a stable equilibrium other than
/// the reference.
void try_other_equilibrium(const force_model::Rod& rod, const SimulationEnd& trajectory,
                           double reference_energy, double tolerance, StabilityResult& result) {
  const Eigen::Matrix3Xd& end = trajectory.late_shapes.back();
  // solve_polygon needs an initial guess without segments of zero length.
  if (!(chord_lengths(end).minCoeff() > 0)) return;
  const energy_model::PolygonResult other = energy_model::solve_polygon(polygon_problem(rod), end);
  if (!energy_model::succeeded(other.status)) return;
  if (classify(trajectory, other.points, rod.length(), tolerance) != Outcome::pass) return;
  result.outcome = Outcome::pass;
  result.note = fmt::format(
      "another stable equilibrium, {:.3g} l from the reference; energy {:.9g} J, there {:.9g} J",
      result.error_over_length, other.energy, reference_energy);
  result.error_over_length = largest_distance(end, other.points) / rod.length();
}

StabilityResult refused(const HardCase& hard, Stepper stepper) {
  StabilityResult result{.name = hard.name, .difficulty = hard.difficulty, .stepper = stepper};
  result.outcome = Outcome::refused;
  result.error_over_length = std::numeric_limits<double>::quiet_NaN();
  result.note = hard.refusal;
  return result;
}

StabilityResult run_with_reference(const energy_model::PolygonResult& reference,
                                   const HardCase& hard, Stepper stepper,
                                   const StabilityOptions& options) {
  StabilityResult result{.name = hard.name, .difficulty = hard.difficulty, .stepper = stepper};
  const force_model::Rod rod = hard.rod(1);
  force_model::Simulation simulation(hard.rod(0), hard.start, options_for(hard, stepper));
  const bool detects_rest = stepper == Stepper::automatic || stepper == Stepper::implicit;
  const long budget = detects_rest ? options.max_steps_auto : options.max_steps;
  const bool rests = hard.steps_at_rest > 0;
  // An implicit step costs about as much as a hundred explicit ones.
  const long at_rest_steps =
      stepper == Stepper::implicit ? std::max(1L, hard.steps_at_rest / 100) : hard.steps_at_rest;
  SimulationEnd trajectory;
  if (move_gripper(hard, simulation)) {
    trajectory =
        rests ? step_from_rest(simulation, at_rest_steps) : step_until_rest(simulation, budget);
  } else {
    trajectory.late_shapes.push_back(simulation.points());
  }
  const double tolerance = rests ? rest_displacement : options.tolerance;
  result.outcome = classify(trajectory, reference.points, rod.length(), tolerance);
  result.steps = simulation.steps();
  result.at_rest = trajectory.at_rest;
  const Eigen::Matrix3Xd& end = trajectory.late_shapes.back();
  result.error_over_length = trajectory.finite
                                 ? largest_distance(end, reference.points) / rod.length()
                                 : std::numeric_limits<double>::infinity();
  if (rests) {
    const double before = force_model::energy(rod, hard.start).total();
    const double growth = force_model::energy(rod, end).total() - before;
    const double share = growth / std::abs(before);
    result.note = fmt::format("energy changed by {:.2g} of its size", share);
    if (result.outcome == Outcome::pass && !(share <= rest_energy_growth))
      result.outcome = Outcome::wrong;
  } else if (result.outcome == Outcome::wrong) {
    result.note = trajectory.at_rest ? "at rest in another shape" : "still creeping";
    try_other_equilibrium(rod, trajectory, reference.energy, tolerance, result);
  }
  return result;
}

/// Whether a sequence of shapes oscillates. Two conditions hold: the sum of their movements exceeds
/// three times the distance from the first shape to the last, and it exceeds `threshold` [m] (RMS
/// over the points). Fewer than three shapes do not oscillate.
bool oscillates(const std::vector<Eigen::Matrix3Xd>& shapes, double threshold) {
  if (shapes.size() < 3) return false;
  double path = 0;
  for (std::size_t i = 1; i < shapes.size(); ++i) path += (shapes[i] - shapes[i - 1]).norm();
  const double net = (shapes.back() - shapes.front()).norm();
  const double root_points = std::sqrt(static_cast<double>(shapes.front().cols()));
  return path > 3 * net && path > threshold * root_points;
}

}  // namespace

double largest_distance(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& reference) {
  if (!points.allFinite()) return std::numeric_limits<double>::infinity();
  return (points - reference).colwise().norm().maxCoeff();
}

Outcome classify(const SimulationEnd& trajectory, const Eigen::Matrix3Xd& reference, double length,
                 double tolerance) {
  constexpr double divergence_distance = 10;  // in lengths
  if (!trajectory.finite || trajectory.late_shapes.empty()) return Outcome::diverges;
  if (!(largest_distance(trajectory.late_shapes.back(), reference) <
        divergence_distance * length)) {
    return Outcome::diverges;
  }
  const auto right = [&](const Eigen::Matrix3Xd& shape) {
    return largest_distance(shape, reference) <= tolerance * length;
  };
  const bool stays = trajectory.at_rest || std::all_of(trajectory.late_shapes.begin(),
                                                       trajectory.late_shapes.end(), right);
  if (stays && right(trajectory.late_shapes.back())) return Outcome::pass;
  const double threshold = tolerance * length;
  if (!trajectory.at_rest && (oscillates(trajectory.late_shapes, threshold) ||
                              oscillates(trajectory.last_shapes, threshold))) {
    return Outcome::oscillates;
  }
  return Outcome::wrong;
}

StabilityResult run_hard_case(const HardCase& hard, Stepper stepper,
                              const StabilityOptions& options) {
  if (!hard.refusal.empty()) return refused(hard, stepper);
  return run_with_reference(reference_of(hard), hard, stepper, options);
}

std::vector<StabilityResult> stability(const StabilityOptions& options) {
  std::vector<HardCase> cases = hard_cases(options.steps_at_rest);
  std::string names;
  for (const HardCase& hard : cases) names += (names.empty() ? "" : ", ") + hard.name;
  std::erase_if(cases, [&](const HardCase& hard) {
    return hard.name.find(options.name_contains) == std::string::npos ||
           std::find(options.excluded.begin(), options.excluded.end(), hard.name) !=
               options.excluded.end();
  });
  if (cases.empty()) {
    throw InputError(fmt::format("no hard case's name contains '{}' (allowed: part of {})",
                                 options.name_contains, names));
  }
  const std::size_t steppers = options.steppers.size();
  std::vector<energy_model::PolygonResult> references(cases.size());
  std::vector<StabilityResult> results(cases.size() * steppers);
  ProgressCounter counter(options.progress,
                          static_cast<std::int64_t>(references.size() + results.size()));
  const auto find_reference = [&](std::size_t i) {
    if (cases[i].refusal.empty()) references[i] = reference_of(cases[i]);
    counter.add_one();
  };
  const auto run = [&](std::size_t i) {
    const HardCase& hard = cases[i / steppers];
    const Stepper stepper = options.steppers[i % steppers];
    results[i] = hard.refusal.empty()
                     ? run_with_reference(references[i / steppers], hard, stepper, options)
                     : refused(hard, stepper);
    counter.add_one();
  };
  tbb::task_arena arena(arena_threads(options.threads));
  execute(arena, [&] {
    tbb::parallel_for(std::size_t{0}, cases.size(), find_reference);
    tbb::parallel_for(std::size_t{0}, results.size(), run);
  });
  return results;
}

}  // namespace dlo::compare
