#include "rest_search.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "require.hpp"

namespace dlo::force_model {
namespace {

// Steps before a measurement without signs of rest.
constexpr long steps_to_forced_measurement = 50'000;
constexpr long clock_steps = 64;  // steps between readings of the clock (cost: one step)

}  // namespace

const char* to_string(RelaxStatus status) {
  switch (status) {
    case RelaxStatus::at_rest:
      return "at rest";
    case RelaxStatus::step_limit:
      return "step limit";
    case RelaxStatus::time_limit:
      return "time limit";
    case RelaxStatus::stalled:
      return "no step lowers the energy";
    case RelaxStatus::diverged:
      break;
  }
  return "diverged";
}

RestSearch::RestSearch(const Rod& rod, const ModeEstimate& estimate, const RelaxOptions& options)
    : rod_(rod), estimate_(estimate), options_(options) {
  require_positive("Simulation::relax", "tolerance", options.tolerance);
  require(options.time_limit > 0, "Simulation::relax", "time_limit", options.time_limit, "> 0");
  result_.status = RelaxStatus::step_limit;
  next_measurement_ = steps_to_forced_measurement;
  target_ = options.tolerance * rod.length();
}

bool RestSearch::may_continue() const {
  return result_.status == RelaxStatus::step_limit && result_.steps < options_.max_steps;
}

bool RestSearch::count(const StepResult& step) {
  if (step.status == StepStatus::diverged) {
    result_.status = RelaxStatus::diverged;
    return false;
  }
  ++result_.steps;
  if (result_.steps % clock_steps == 0) check_clock();
  return result_.steps % block_steps == 0 && result_.steps >= next_check_;
}

void RestSearch::check_clock() {
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin_;
  const bool stopped = options_.interrupted != nullptr && options_.interrupted();
  if (stopped || taken.count() > options_.time_limit) result_.status = RelaxStatus::time_limit;
}

void RestSearch::count_newton_steps(const StepResult& step, long solves) {
  if (step.status == StepStatus::diverged) {
    result_.status = RelaxStatus::diverged;
    return;
  }
  result_.steps += solves;
  check_clock();
}

Eigen::Matrix3Xd RestSearch::end_if_at_rest(const MovingShape& shape) {
  EquilibriumCheck check = measure(shape);
  if (is_at_rest(check)) result_.status = RelaxStatus::at_rest;
  return is_at_rest(check) ? Eigen::Matrix3Xd() : std::move(check.negative_curvature_direction);
}

bool RestSearch::is_at_rest(const EquilibriumCheck& check) const {
  return check.stable && check.proven &&
         result_.remaining_error < std::max(target_, check.rounding_error);
}

EquilibriumCheck RestSearch::measure(const MovingShape& shape) {
  EquilibriumCheck check = check_equilibrium(rod_, shape.points);
  neutral_modes_ = check.neutral_modes;
  result_.remaining_error = std::max(check.remaining_error, shape.momentum);
  return check;
}

Eigen::Matrix3Xd RestSearch::check_rest(const MovingShape& shape) {
  // Simple signs are checked first. The proof of rest is the Newton step and the stiffness.
  const double root_points = std::sqrt(static_cast<double>(shape.points.cols()));
  const double distance = shape.forces.norm() / estimate_.modes().slowest / root_points;
  const bool seems_at_rest = std::max(distance, shape.momentum) < target_;
  bounces_ = false;
  slowest_mode_ = std::numeric_limits<double>::infinity();
  // Rounding of many stiff points' positions causes forces that hide rest from these signs
  // permanently. If there is no force at all, further steps give no more information: the paper's
  // law has no stiffness where the rod is straight, so its modes do not determine the distance.
  const double rounding = 64 * std::numeric_limits<double>::epsilon() * rod_.c_c *
                          shape.points.cwiseAbs().maxCoeff() / rod_.rest_lengths.minCoeff();
  const bool forceless = shape.forces.cwiseAbs().maxCoeff() <= rounding;
  const bool due = result_.steps >= next_measurement_ || (forceless && !measured_without_force_);
  measured_without_force_ = measured_without_force_ || forceless;
  if (!seems_at_rest && !due) return {};
  next_measurement_ = std::max(next_measurement_, result_.steps + result_.steps / 4);
  EquilibriumCheck check = measure(shape);
  if (is_at_rest(check)) {
    result_.status = RelaxStatus::at_rest;
    return {};
  }
  // While contacts open and close, the stiffness of one shape is not that of the next, so the
  // measured mode is used only if it is proven or if the rod seemed to be at rest. If the rod
  // seemed so wrongly, this mode is better than the estimate that caused it.
  if (check.stable && (check.proven || seems_at_rest)) slowest_mode_ = check.slowest_mode;
  // With obstacles the motion is also damped farther from rest, because a contact that opens and
  // closes prevents a proof of rest.
  const double nearly = rod_.has_obstacles() ? 100 : 1;
  // The steps of a descent have no momentum. A shape that only creeps in such steps needs momentum,
  // so no further descent follows one that did not halve the distance from rest.
  constexpr double required_descent_ratio = 0.5;
  bounces_ = due && check.stable && check.remaining_error < nearly * target_ &&
             check.remaining_error < required_descent_ratio * descended_from_;
  descended_from_ = bounces_ ? check.remaining_error : std::numeric_limits<double>::infinity();
  if (bounces_) next_measurement_ = result_.steps + descent_steps;
  if (!seems_at_rest) return {};
  next_check_ = result_.steps + std::max(block_steps, result_.steps / 10);
  return std::move(check.negative_curvature_direction);
}

RelaxResult RestSearch::finish(const MovingShape& shape) {
  if (result_.status != RelaxStatus::diverged && result_.status != RelaxStatus::at_rest) {
    const EquilibriumCheck check = measure(shape);
    if (is_at_rest(check)) result_.status = RelaxStatus::at_rest;
  }
  result_.message = to_string(result_.status);
  if (result_.status == RelaxStatus::at_rest && neutral_modes_ > 0) {
    result_.message += ", except for " + std::to_string(neutral_modes_) +
                       (neutral_modes_ == 1 ? " movement" : " movements") + " without stiffness";
  }
  return result_;
}

}  // namespace dlo::force_model
