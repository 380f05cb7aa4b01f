#include "step_control.hpp"

#include <algorithm>
#include <cmath>

#include "require.hpp"

namespace dlo::force_model {
namespace {

const StepOptions& checked(const StepOptions& options) {
  const StepPolicy& policy = options.policy;
  if (policy.integration != Integration::along_force) {
    const bool timeless =
        policy.integration == Integration::implicit_euler && std::isinf(options.time_step);
    require(options.time_step > 0 && (timeless || std::isfinite(options.time_step)), "Simulation",
            "time_step", options.time_step, timeless ? "> 0" : "finite and > 0");
    require_not_negative("Simulation", "damping_rate", options.damping_rate);
  } else if (!policy.automatic) {
    require_positive("Simulation", "c_F", options.c_F);
    if (policy.limit != StepLimit::none) require_positive("Simulation", "l_s", options.l_s);
    if (policy.momentum) {
      require(options.c_h >= 0 && options.c_h < 1, "Simulation", "c_h", options.c_h, "in [0, 1)");
    }
  }
  require_not_negative("Simulation", "l_s", options.l_s);
  require_not_negative("Simulation", "c_s_change", options.c_s_change);
  return options;
}

}  // namespace

StepControl::StepControl(const Rod& rod, const Eigen::Matrix3Xd& points, const StepOptions& options)
    : options_(checked(options)), estimate_(rod, points) {
  if (options_.policy.automatic && options_.l_s == 0) {
    options_.l_s = rod.rest_lengths.minCoeff() / 4;
  }
  choose_constants();
}

void StepControl::update_modes(double inner_mode, double force_change, double point_change) {
  if (descends()) {
    estimate_.update_fastest(inner_mode);
  } else {
    estimate_.update(inner_mode, force_change, point_change);
  }
  choose_constants();
}

void StepControl::correct_slowest_mode(double slowest) {
  estimate_.correct_slowest(slowest);
  choose_constants();
}

void StepControl::change_environment(const Rod& rod, const Eigen::Matrix3Xd& points) {
  estimate_.change_environment(rod, points);
  choose_constants();
}

void StepControl::descend() {
  descends_until_ = steps_ + descent_steps;
  choose_constants();
}

void StepControl::choose_constants() {
  if (!options_.policy.automatic) return;
  const ModeBounds& modes = estimate_.modes();
  const HeavyBall chosen = descends() ? HeavyBall{1 / modes.fastest, 0} : heavy_ball(modes);
  options_.c_F = chosen.c_F;
  options_.c_h = chosen.c_h;
}

void StepControl::decide(double largest_squared, double sum_squared, double oscillating,
                         StepResult& result) {
  const StepPolicy& policy = options_.policy;
  result.status = StepStatus::diverged;
  result.c_m = 0;
  result.limited = false;
  result.movement = std::sqrt(largest_squared);  // (16), (18)
  if (!std::isfinite(result.movement) || !std::isfinite(sum_squared)) return;
  if (policy.damping) {
    const double change = options_.c_s_change;
    c_s_ = oscillating > 0 ? c_s_ + change * oscillating : std::max(1.0, c_s_ - change);
  }
  result.status = StepStatus::good;
  result.c_m = 1 / c_s_;
  if (policy.limit != StepLimit::none && result.movement > options_.l_s) {
    result.c_m *= options_.l_s / result.movement;  // (17), (18), (20)
    result.limited = true;
    ++limited_steps_;
  }
  ++steps_;
  if (c_s_ > 1) ++damped_steps_;
}

void StepControl::count(const StepResult& result, long evaluations) {
  if (result.status == StepStatus::diverged) return;
  steps_ += evaluations;
  if (result.limited) ++limited_steps_;
}

}  // namespace dlo::force_model
