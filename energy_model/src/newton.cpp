#include "newton.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace dlo::energy_model {
namespace {

/// Relative residual whose next Newton step squares it to below rounding.
constexpr double last_residual = 1e-8;

/// A factor is used again for a last step as long as x has moved less than this since: the residual
/// still falls by that much.
constexpr double factor_reach = 1e-3;

}  // namespace

void Newton::begin(SpanSolution& solution) {
  const SpanEnergy& model = *solution.model;
  gradient_.resize(model.size());
  residual_.resize(model.constraints());
  jacobian_.resize(model.constraints(), model.size());
  if (solution.multipliers.size() == model.constraints()) return;
  solution.multipliers.setZero(model.constraints());
  if (model.constraints() == 0) return;
  // The multipliers that balance the gradient best.
  (void)evaluate(solution);
  solution.multipliers = jacobian_.transpose().householderQr().solve(gradient_);
}

double Newton::evaluate(SpanSolution& solution) {
  SpanEnergy& model = *solution.model;
  solution.energy = model.value(solution.x, gradient_);
  ++solution.evaluations;
  if (model.constraints() == 0) return gradient_.norm();
  model.constraint(residual_, jacobian_);
  gradient_.noalias() -= jacobian_.transpose() * solution.multipliers;
  return std::hypot(gradient_.norm(), (1 + load_) * residual_.norm());
}

void Newton::factor(SpanSolution& solution) {
  solution.model->hessian(solution.multipliers, hessian_);
  const Eigen::Index n = hessian_.rows();
  const Eigen::Index m = jacobian_.rows();
  definite_ = false;
  if (m == 0) {
    llt_.compute(hessian_);
    definite_ = llt_.info() == Eigen::Success;
    if (definite_) return;
  }
  system_.resize(n + m, n + m);
  system_.topLeftCorner(n, n) = hessian_;
  system_.topRightCorner(n, m) = -jacobian_.transpose();
  system_.bottomLeftCorner(m, n) = jacobian_;
  system_.bottomRightCorner(m, m).setZero();
  lu_.compute(system_);
}

/// Into step_, from gradient_ and residual_.
void Newton::solve() {
  if (definite_) {
    step_ = -gradient_;
    llt_.solveInPlace(step_);
    return;
  }
  right_.resize(gradient_.size() + residual_.size());
  right_ << -gradient_, -residual_;
  step_ = lu_.solve(right_);
  // A neutral direction leaves the system singular; least squares stands still along it.
  if (!((system_ * step_ - right_).norm() <= 1e-6 * right_.norm()) || step_.norm() > 1e3) {
    step_ = system_.completeOrthogonalDecomposition().solve(right_);
  }
}

void Newton::move(SpanSolution& solution, double length) {
  solution.x += length * step_.head(gradient_.size());
  if (residual_.size() > 0) solution.multipliers += length * step_.tail(residual_.size());
}

double Newton::step_length_by_energy(SpanSolution& solution) {
  const double slope = gradient_.dot(step_);
  const double rounding = 1e-14 * (1 + std::abs(solution.energy));
  trial_gradient_.resize(gradient_.size());
  for (double length = 1; length > 1e-4; length /= 2) {
    ++solution.evaluations;
    trial_x_ = solution.x + length * step_;
    const double energy = solution.model->value(trial_x_, trial_gradient_);
    if (energy <= solution.energy + 1e-4 * length * slope + rounding) return length;
  }
  return 1e-4;
}

/// Walls make the energy's second derivative jump: Newton's step is halved until the energy falls,
/// or between grips the residual.
double Newton::step_length(SpanSolution& solution, double size) {
  if (!solution.model->has_walls()) return 1;
  if (definite_) return step_length_by_energy(solution);
  trial_x_ = solution.x;
  trial_multipliers_ = solution.multipliers;
  double best = 1e-3;
  for (double length = 1; length > 1e-3; length /= 2) {
    move(solution, length);
    const double trial = evaluate(solution);
    solution.x = trial_x_;
    solution.multipliers = trial_multipliers_;
    if (trial < (1 - 1e-4 * length) * size) {
      best = length;
      break;
    }
  }
  return best;
}

void Newton::polish(SpanSolution& solution, double load) {
  load_ = load;
  begin(solution);
  const bool walls = solution.model->has_walls();
  const int most_steps = walls ? 60 : 12;
  double previous = HUGE_VAL;
  double moved = HUGE_VAL;
  for (int step = 0; step < most_steps; ++step) {
    const double size = evaluate(solution);
    solution.residual = size;
    const bool stalled = size > 0.5 * previous && size > 1e-9 * (1 + load);
    if (!std::isfinite(size) || (stalled && !walls)) break;
    previous = size;
    const bool last = size <= last_residual * (1 + load);
    if (!last || moved * (1 + load) > factor_reach) factor(solution);
    solve();
    if (last) {
      const bool minimum = definite_ || jacobian_.rows() > 0;
      move(solution, 1);
      // No evaluation has to prove that this step has squared the residual.
      return solution.finish(minimum ? SolveStatus::converged : SolveStatus::saddle);
    }
    const double length = step_length(solution, size);
    move(solution, length);
    moved = length * step_.norm();
  }
  solution.fail("Newton's method did not reduce the residual to rounding");
}

void Newton::lead(SpanSolution& solution, double load, int max_evaluations) {
  load_ = load;
  solution.multipliers.resize(0);
  begin(solution);
  (void)evaluate(solution);
  const Eigen::VectorXd first_gradient = gradient_;
  const Eigen::VectorXd first_residual = residual_;
  double reached = 0;
  double stride = 0.2;
  const int limit = solution.evaluations + max_evaluations;
  while (reached < 1 && stride > 1e-3 && solution.evaluations < limit) {
    const double target = std::min(1.0, reached + stride);
    const Eigen::VectorXd x = solution.x;
    const Eigen::VectorXd multipliers = solution.multipliers;
    bool arrived = false;
    for (int step = 0; step < 6 && !arrived; ++step) {
      (void)evaluate(solution);
      gradient_ -= (1 - target) * first_gradient;
      residual_ -= (1 - target) * first_residual;
      const double size = std::hypot(gradient_.norm(), (1 + load_) * residual_.norm());
      arrived = size < 1e-4 * (1 + load_);
      if (!std::isfinite(size)) break;
      factor(solution);
      solve();
      // A step that large has left the path.
      if (step_.norm() > 5) break;
      move(solution, 1);
    }
    if (arrived) {
      reached = target;
      stride *= 1.6;
    } else {
      solution.x = x;
      solution.multipliers = multipliers;
      stride /= 3;
    }
  }
  if (reached < 1) return solution.fail("no path led from the start to an equilibrium");
  polish(solution, load);
}

}  // namespace dlo::energy_model
