#include "dlo/force_model/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dlo/force_model/tangent_stiffness.hpp"
#include "require.hpp"

namespace dlo::force_model {
namespace {

constexpr long block_steps = 16;      // between two looks at the modes
constexpr double block_memory = 0.8;  // weight of older blocks
// Movements below this share of the coordinates are rounding, which turns back and forth at rest.
constexpr double rounding_share = 1024 * std::numeric_limits<double>::epsilon();

void check(const StepOptions& options) {
  const StepPolicy& policy = options.policy;
  if (!policy.automatic) {
    require_positive("Simulation", "c_F", options.c_F);
    if (policy.limit != StepLimit::none) require_positive("Simulation", "l_s", options.l_s);
    if (policy.momentum) {
      require(options.c_h >= 0 && options.c_h < 1, "Simulation", "c_h", options.c_h, "in [0, 1)");
    }
  }
  require_not_negative("Simulation", "l_s", options.l_s);
  require_not_negative("Simulation", "c_s_change", options.c_s_change);
}

}  // namespace

StepPolicy policy(Stepper stepper) {
  switch (stepper) {
    case Stepper::basic:
      return {};
    case Stepper::limited:
      return {.limit = StepLimit::absolute, .damping = true};
    case Stepper::relative:
      return {.limit = StepLimit::relative, .damping = true};
    case Stepper::dynamic:
      return {.limit = StepLimit::relative, .momentum = true, .damping = true};
    case Stepper::automatic:
      break;
  }
  return {.limit = StepLimit::relative, .momentum = true, .automatic = true};
}

const char* to_string(RelaxStatus status) {
  switch (status) {
    case RelaxStatus::at_rest:
      return "at rest";
    case RelaxStatus::step_limit:
      return "step limit";
    case RelaxStatus::diverged:
      break;
  }
  return "diverged";
}

Simulation::Simulation(Rod rod, Eigen::Matrix3Xd points, const StepOptions& options)
    : rod_(std::move(rod)), options_(options), points_(std::move(points)) {
  force_model::check(rod_);
  check(options_);
  require_polygon("Simulation", points_, rod_.rest_lengths);
  const Eigen::Index n = points_.cols();
  forces_.setZero(3, n);
  movement_.setZero(3, n);
  proposed_.setZero(3, n);
  block_points_.setZero(3, n);
  block_forces_.setZero(3, n);
  turned_back_.setConstant(n, false);
  free_.setOnes(n);
  for (const Grip& grip : rod_.grips) {
    if (grip.hold == GripHold::spring) continue;
    free_.segment(grip.first_point, grip.targets.cols()).setZero();
    points_.middleCols(grip.first_point, grip.targets.cols()) = grip.targets;
  }
  if (options_.policy.automatic && options_.l_s == 0) {
    options_.l_s = rod_.rest_lengths.minCoeff() / 4;
  }
  modes_ = mode_bounds(rod_, points_);
  slowest_expected_ = modes_.slowest;
  if (options_.policy.automatic) {
    const HeavyBall chosen = heavy_ball(modes_);
    options_.c_F = chosen.c_F;
    options_.c_h = chosen.c_h;
  }
}

void Simulation::compute_forces() {
  total_forces(rod_, points_, forces_);
  forces_.array().rowwise() *= free_.transpose();
}

void Simulation::choose_step() {
  const ModeBounds now = mode_bounds(rod_, points_);
  modes_.fastest = now.fastest;
  rounding_ = rounding_share * points_.cwiseAbs().maxCoeff();
  if (block_open_) {
    block_forces_ -= forces_;
    block_points_ = points_ - block_points_;
    force_change_ = block_memory * force_change_ + block_forces_.cwiseProduct(block_points_).sum();
    point_change_ = block_memory * point_change_ + block_points_.squaredNorm();
    if (point_change_ > 0 && force_change_ > 0) modes_.slowest = force_change_ / point_change_;
    modes_.slowest = std::clamp(modes_.slowest, 1e-10 * modes_.fastest, modes_.fastest);
  }
  block_points_ = points_;
  block_forces_ = forces_;
  block_open_ = true;
  if (!options_.policy.automatic) return;
  const HeavyBall chosen = heavy_ball(modes_);
  options_.c_F = chosen.c_F;
  options_.c_h = chosen.c_h;
}

double Simulation::largest_movement() const {
  if (options_.policy.limit != StepLimit::relative) {
    return std::sqrt(proposed_.colwise().squaredNorm().maxCoeff());  // (16)
  }
  double largest = 0;
  for (Eigen::Index i = 0; i + 1 < proposed_.cols(); ++i) {
    // (18); not std::max, which would drop a NaN
    const double squared = (proposed_.col(i) - proposed_.col(i + 1)).squaredNorm();
    if (!(squared <= largest)) largest = squared;
  }
  return std::sqrt(largest);
}

void Simulation::update_damping() {
  long oscillating = 0;
  for (Eigen::Index i = 0; i < proposed_.cols(); ++i) {
    const bool turns = proposed_.col(i).dot(movement_.col(i)) < -rounding_ * rounding_;
    if (turns && turned_back_[i]) ++oscillating;
    turned_back_[i] = turns;
  }
  const double change = options_.c_s_change;
  c_s_ = oscillating > 0 ? c_s_ + change * static_cast<double>(oscillating)
                         : std::max(1.0, c_s_ - change);
}

StepResult Simulation::step() {
  compute_forces();
  if (steps_ % block_steps == 0) choose_step();
  const StepPolicy& policy = options_.policy;
  proposed_ = options_.c_F * forces_;
  if (policy.momentum) proposed_ += options_.c_h * movement_;  // (19)
  StepResult result;
  result.movement = largest_movement();
  if (!std::isfinite(result.movement) || !std::isfinite(proposed_.sum())) return result;
  if (policy.damping) update_damping();
  result.status = StepStatus::good;
  result.c_m = 1 / c_s_;
  if (policy.limit != StepLimit::none && result.movement > options_.l_s) {
    result.c_m *= options_.l_s / result.movement;  // (17), (18), (20)
    result.limited = true;
    ++limited_steps_;
  }
  movement_ = result.c_m * proposed_;
  points_ += movement_;
  ++steps_;
  if (c_s_ > 1) ++damped_steps_;
  return result;
}

StepResult Simulation::advance(double steps, long max_steps) {
  require_positive("Simulation::advance", "steps", steps);
  owed_steps_ += steps;
  StepResult result{.status = StepStatus::good};
  // Text 1 makes a step even when none is owed; calls for less than one step would run ahead. The
  // c_m sum to whole numbers up to rounding, which is not worth another step either.
  for (long i = 0; i < max_steps && owed_steps_ > 5e-7; ++i) {
    result = step();
    if (result.status == StepStatus::diverged) break;
    owed_steps_ -= result.c_m;
  }
  return result;
}

void Simulation::nudge() {
  // Far below any tolerance, and towards +x as an upright rod's plane opens (+y for a rod along x).
  const Eigen::Vector3d rod = points_.col(points_.cols() - 1) - points_.col(0);
  const Eigen::Index axis = std::abs(rod.x()) < 0.9 * rod.norm() ? 0 : 1;
  const double size = 1e-6 * rod_.length() / static_cast<double>(points_.cols());
  double shift = 0;
  const bool from_start = free_[0] == 0;
  for (Eigen::Index k = 0; k < points_.cols(); ++k) {
    const Eigen::Index i = from_start ? k : points_.cols() - 1 - k;
    shift += size * free_[i];
    points_(axis, i) += shift;
  }
}

RelaxResult Simulation::relax(const RelaxOptions& options) {
  require_positive("Simulation::relax", "tolerance", options.tolerance);
  RelaxResult result;
  result.status = RelaxStatus::step_limit;
  // Forces of stiff segments carry the rounding of the positions; no step gets below what it moves.
  const double rounding = std::numeric_limits<double>::epsilon() * rod_.c_c *
                          points_.cwiseAbs().maxCoeff() / rod_.rest_lengths.minCoeff() /
                          std::min(slowest_expected_, modes_.slowest);
  const double target = std::max(options.tolerance * rod_.length(), rounding);
  const double root_points = std::sqrt(static_cast<double>(points_.cols()));
  long next_check = 2 * block_steps;
  const auto momentum = [&] {
    return options_.policy.momentum ? movement_.norm() / (1 - options_.c_h) / root_points : 0;
  };
  const auto measure = [&] {
    compute_forces();
    result.residual_force = std::sqrt(forces_.colwise().squaredNorm().maxCoeff());
    const EquilibriumCheck check = check_equilibrium(rod_, points_);
    result.remaining_error = std::max(check.remaining_error, momentum());
    return check.stable;
  };
  while (result.steps < options.max_steps) {
    const StepResult last = step();
    if (last.status == StepStatus::diverged) {
      result.status = RelaxStatus::diverged;
      break;
    }
    ++result.steps;
    if (result.steps % block_steps != 0 || result.steps < next_check) continue;
    // Cheap signs first; what proves rest is Newton's step and the stiffness behind it.
    compute_forces();
    const double estimate = forces_.norm() / modes_.slowest / root_points;
    if (std::max(estimate, momentum()) >= target) continue;
    const bool stable = measure();
    if (stable && result.remaining_error < target) {
      result.status = RelaxStatus::at_rest;
      break;
    }
    // An equilibrium that does not hold, as an upright rod's: whatever disturbs it makes it fall.
    if (!stable) nudge();
    next_check = result.steps + std::max(block_steps, result.steps / 10);
  }
  if (result.status == RelaxStatus::step_limit) (void)measure();
  result.message = to_string(result.status);
  return result;
}

void Simulation::move_grip(std::size_t grip, const Eigen::Ref<const Eigen::Matrix3Xd>& targets,
                           const Eigen::Vector3d& reference) {
  require(grip < rod_.grips.size(), "Simulation::move_grip", "grip", static_cast<double>(grip),
          "smaller than the number of grips");
  Grip& moved = rod_.grips[grip];
  require(targets.cols() == moved.targets.cols(), "Simulation::move_grip", "columns of targets",
          static_cast<double>(targets.cols()), "the number of points held");
  require(targets.allFinite() && reference.allFinite(), "Simulation::move_grip", "targets",
          targets.norm(), "finite");
  moved.targets = targets;
  moved.reference = reference;
  if (moved.hold == GripHold::rigid) {
    points_.middleCols(moved.first_point, targets.cols()) = targets;
  }
}

void Simulation::move_wall(std::size_t wall, const Wall& moved) {
  require(wall < rod_.walls.size(), "Simulation::move_wall", "wall", static_cast<double>(wall),
          "smaller than the number of walls");
  force_model::check(moved);
  rod_.walls[wall] = moved;
  // Forces before and after do not compare, so the block that estimates the slowest mode is void.
  block_open_ = false;
  choose_step();
  block_open_ = false;
}

}  // namespace dlo::force_model
