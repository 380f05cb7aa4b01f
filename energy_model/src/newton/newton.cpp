#include "newton/newton.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace dlo::energy_model {
namespace {

/// Relative residual at which rounding may be what is left of it.
constexpr double last_residual = 1e-8;

/// Newton's step, of which the shape's error is a part, at which it need not go
/// on [rad].
constexpr double finest_step = 1e-11;

/// Steps that become shorter by this with a factor of another point's need no new one.
constexpr double fast_contraction = 0.1;

/// Directions in which the rod moves for next to nothing.
constexpr Eigen::Index most_neutral = 3;

/// Steps to a shape next to another one, and the longest of them [rad].
constexpr int most_nearby_steps = 10;
constexpr double longest_nearby = 10;
/// A neighbour's factor is left for a shape's own at this step [rad]: the next one, as large as its
/// square, is at rounding.
constexpr double last_borrowed_step = 1e-6;

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
  prolonged_ = false;
  definite_ = false;
  factored_.model = nullptr;
  if (jacobian_.rows() == 0) {
    definite_ = definite_factor_.compute(hessian_);
    system_known_ = false;
    if (definite_) return remember_factor(solution);
  }
  pull_ = 1 + load_ + solution.multipliers.norm();
  factor_system();
  remember_factor(solution);
  if (stands_still_) find_neutral();
}

void Newton::remember_factor(const SpanSolution& solution) {
  factored_.model = solution.model.get();
  factored_.x = solution.x;
  factored_.multipliers = solution.multipliers;
}

void Newton::factor_at(const SpanSolution& solution, const Eigen::MatrixXd& jacobian) {
  solution.model->hessian(solution.multipliers, hessian_);
  prolonged_ = false;
  definite_ = false;
  pull_ = 1 + load_ + solution.multipliers.norm();
  jacobian_ = jacobian;
  factor_system();
  remember_factor(solution);
}

double Newton::distance_of_factor(const SpanSolution& solution) const {
  if (!has_factor_of(solution.model.get())) return std::numeric_limits<double>::infinity();
  return (solution.x - factored_.x).norm() +
         (solution.multipliers - factored_.multipliers).norm() / scale_of(solution);
}

/// In terms beyond those of the last Hessian bending outweighs what forces add,
/// with the square of the order.
void Newton::prolong(const SpanEnergy& model, const SpanEnergy& fewer) {
  const std::vector<Eigen::Index> places = model.places_of(fewer);
  const Eigen::MatrixXd known = hessian_;
  hessian_.setIdentity(model.size(), model.size());
  for (std::size_t j = 0; j < places.size(); ++j) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      hessian_(places[i], places[j]) =
          known(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  }
  prolonged_ = true;
  prolong_next_ = true;
  factored_.model = nullptr;
  definite_ = false;
}

void Newton::factor_system() {
  system_.compute(hessian_, jacobian_);
  system_known_ = true;
  broyden_.clear();
}

NewtonSystem& Newton::system() {
  if (!system_known_) factor_system();
  return system_;
}

/// Into neutral_: orthonormal vectors that the system makes shorter than `neutral`, by inverse
/// iteration; a step along them would be any. Multipliers count by their own size, or a gap that
/// grips hardly close would pass for neutral.
void Newton::find_neutral() {
  const Eigen::Index size = gradient_.size() + residual_.size();
  neutral_.resize(size, 0);
  const Eigen::VectorXd seed = Eigen::VectorXd::LinSpaced(size, 1, 2).normalized();
  Eigen::VectorXd right;
  for (Eigen::Index found = 0; found < most_neutral; ++found) {
    Eigen::VectorXd v = seed;
    double shrinks = 1;
    for (int i = 0; i < 2; ++i) {
      v.tail(residual_.size()) /= pull_;
      right = v;
      system_.solve(right, v);
      v.tail(residual_.size()) /= pull_;
      v -= neutral_ * (neutral_.transpose() * v);
      shrinks = 1 / v.norm();
      v *= shrinks;
    }
    if (!(shrinks < neutral)) return;
    neutral_.conservativeResize(Eigen::NoChange, found + 1);
    neutral_.col(found) = v;
  }
}

void Newton::stand_still() {
  auto multipliers = step_.tail(residual_.size());
  multipliers /= pull_;
  step_ -= neutral_ * (neutral_.transpose() * step_);
  multipliers *= pull_;
}

/// Into step_, from gradient_ and residual_.
void Newton::solve() {
  if (definite_) {
    step_ = -gradient_;
    definite_factor_.solve(step_);
    return;
  }
  right_.resize(gradient_.size() + residual_.size());
  right_ << -gradient_, -residual_;
  system_.solve(right_, step_);
  if (stands_still_) stand_still();
  // A neutral direction leaves the system singular; least squares stands still along it.
  constexpr double longest = 1e3;
  if (nearby_ || system_.is_met(right_, step_, longest)) return;
  step_ = system_.across_neutral(right_);
}

void Newton::stand_still_where_neutral() {
  right_ << -gradient_, -residual_;
  step_ = system_.across_neutral(right_);
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

/// Obstacles make the energy's second derivative jump: Newton's step is halved until the energy
/// falls, or between grips the residual.
double Newton::step_length(SpanSolution& solution, double size) {
  if (!solution.model->has_soft_obstacles()) return 1;
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

/// Length of a step, multipliers by their own size.
double Newton::length_of(const SpanSolution& solution) const {
  const Eigen::Index n = gradient_.size();
  const double shape = step_.head(n).norm();
  if (residual_.size() == 0) return shape;
  return std::hypot(shape, step_.tail(residual_.size()).norm() / scale_of(solution));
}

double Newton::scale_of(const SpanSolution& solution) const {
  return 1 + load_ + solution.multipliers.norm();
}

bool Newton::is_at_rounding(const SpanSolution& solution, double size) const {
  return size <= last_residual * scale_of(solution);
}

/// Moves along the step, by a quarter as much as long as the next step with the same factor is not
/// shorter: Deuflhard's natural monotonicity, which does not depend on how gradients and gaps are
/// weighed against each other. That step is left in step_, the residual in `size`.
/// With constraints it is Broyden's, from all whole steps with this factor.
/// @return whether there is such a part; the solution is where it was if not
bool Newton::natural_move(SpanSolution& solution, double& size) {
  constexpr double longest = 2;        // of a step; angles of this size have left the path
  constexpr double least_part = 1e-5;  // of a step
  trial_x_ = solution.x;
  trial_multipliers_ = solution.multipliers;
  first_step_ = step_;
  const double length = length_of(solution);
  const double moves = step_.head(gradient_.size()).norm();
  const double first = std::min(1.0, longest / moves);
  // So short a step is cut for nothing: if the next one is no shorter both are made of rounding.
  const bool short_enough = moves <= coarsest_step && is_at_rounding(solution, size);
  const double least = short_enough ? first / 2 : least_part;
  for (double part = first; part > least && !deadline_.passed(); part /= 4) {
    step_ = first_step_;
    move(solution, part);
    size = evaluate(solution);
    if (std::isfinite(size)) {
      solve();
      if (length_of(solution) < (1 - part / 4) * length) {
        // A part of a step, and one that stands still, says less of the factor.
        if (part < 1 || stands_still_) {
          broyden_.clear();
        } else if (residual_.size() > 0) {
          update_step();
        }
        return true;
      }
    }
    solution.x = trial_x_;
    solution.multipliers = trial_multipliers_;
  }
  step_ = first_step_;
  size = evaluate(solution);
  return false;
}

/// Into step_, which the factor gives after the whole step first_step_: Broyden's. Multipliers
/// count by their own size.
void Newton::update_step() {
  auto first_multipliers = first_step_.tail(residual_.size());
  auto multipliers = step_.tail(residual_.size());
  first_multipliers /= pull_;
  multipliers /= pull_;
  broyden_.update(first_step_, step_);
  multipliers *= pull_;
}

/// Of the Hessian that is factored, by inverse iteration from a vector that low modes share: not
/// below the smallest eigenvalue, and next to it where that is far below the others.
double Newton::softest_of_factor() {
  constexpr int iterations = 2;
  const Eigen::Index n = gradient_.size();
  soft_.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) soft_[i] = 1 / static_cast<double>(1 + i);
  double grows = 1;
  for (int i = 0; i < iterations; ++i) {
    soft_ /= soft_.norm();
    definite_factor_.solve(soft_);
    grows = soft_.norm();
  }
  return 1 / grows;
}

void Newton::polish_along_branch(SpanSolution& solution, double load) {
  stands_still_ = true;
  run(solution, load);
  stands_still_ = false;
}

void Newton::polish_roughly(SpanSolution& solution, double load) {
  rough_ = true;
  polish(solution, load);
  rough_ = false;
}

void Newton::polish(SpanSolution& solution, double load) {
  const SpanEnergy& model = *solution.model;
  if (model.constraints() == 0 || model.has_soft_obstacles()) return run(solution, load);
  const Eigen::VectorXd x = solution.x;
  const Eigen::VectorXd multipliers = solution.multipliers;
  run(solution, load);
  if (solution.is_equilibrium() || solution.status == SolveStatus::time_limit) return;
  solution.x = x;
  solution.multipliers = multipliers;
  polish_along_branch(solution, load);
}

void Newton::polish_with_more_terms(SpanSolution& solution, const SpanSolution& fewer,
                                    double load) {
  const SpanEnergy& model = *solution.model;
  if (model.constraints() > 0 && !model.has_soft_obstacles() && !stands_still_ &&
      hessian_.rows() == fewer.model->size()) {
    prolong(model, *fewer.model);
    ends_on_own_factor_ = true;
  }
  polish(solution, load);
  ends_on_own_factor_ = false;
}

void Newton::polish_nearby(SpanSolution& solution, double load) {
  nearby_ = borrows_ = true;
  run(solution, load);
  nearby_ = borrows_ = false;
}

void Newton::polish_from_neighbour(SpanSolution& solution, double load) {
  ends_on_own_factor_ = borrows_ = true;
  polish(solution, load);
  ends_on_own_factor_ = borrows_ = false;
}

bool Newton::has_factor_for(const SpanEnergy& model) const {
  return model.constraints() > 0 && !definite_ && !stands_still_ &&
         system_.is_of(model.size(), model.constraints());
}

void Newton::run(SpanSolution& solution, double load) {
  load_ = load;
  begin(solution);
  const bool obstacles = solution.model->has_soft_obstacles();
  const int most_steps = obstacles ? 60 : nearby_ ? most_nearby_steps : 30;
  double size = evaluate(solution);
  bool factored = std::exchange(borrows_, false) && !obstacles && has_factor_for(*solution.model);
  if (factored) broyden_.clear();
  if (factored) factored_.model = nullptr;
  bool borrowed = factored || prolong_next_;  // the factor is another shape's
  bool shrinks = false;                       // the steps, with the factor of an earlier point
  bool is_next = false;                       // step_ is the next one already
  const auto finish = [&] {
    solution.residual = size;
    solution.softest = definite_ ? softest_of_factor() : std::numeric_limits<double>::quiet_NaN();
    if (!(solution.multipliers.norm() <= largest_pull * (1 + load))) {
      return solution.fail("Newton's method left for forces without bound");
    }
    const bool minimum = definite_ || jacobian_.rows() > 0;
    solution.finish(minimum ? SolveStatus::converged : SolveStatus::saddle);
  };
  for (int step = 0; step < most_steps; ++step) {
    if (!std::isfinite(size)) break;
    if (deadline_.passed()) {
      solution.residual = size;
      return solution.finish(SolveStatus::time_limit);
    }
    if (std::exchange(prolong_next_, false)) {
      factor_system();
      factored = true;
      is_next = false;
    } else if (!factored) {
      factor(solution);
      borrowed = false;
      is_next = false;
    }
    if (!std::exchange(is_next, false)) solve();
    if (borrowed && ends_on_own_factor_ &&
        step_.head(gradient_.size()).norm() <= last_borrowed_step) {
      factor(solution);
      borrowed = false;
      solve();
    }
    const double moved = step_.head(gradient_.size()).norm();
    solution.next_step = moved;
    if (nearby_ && !borrowed && !(moved <= longest_nearby)) break;
    const bool small = is_at_rounding(solution, size);
    // Where the shape is right the forces need not be.
    if (moved <= finest_step && (small || obstacles)) return finish();
    if (obstacles) {
      const double before = size;
      move(solution, step_length(solution, size));
      size = evaluate(solution);
      solution.next_step = moved * size / before;
    } else if (natural_move(solution, size)) {
      is_next = true;
      solution.next_step = step_.head(gradient_.size()).norm();
      shrinks = solution.next_step < fast_contraction * moved;
    } else {
      // Rounding is all that is left; what it moves a neutral direction by means nothing.
      if (small && moved > coarsest_step && !definite_ && !factored) {
        stand_still_where_neutral();
        solution.next_step = step_.head(gradient_.size()).norm();
      }
      if (small && solution.next_step <= coarsest_step && !borrowed) return finish();
      if (factored) {
        // The factor was another point's.
        factored = false;
        continue;
      }
      solution.residual = size;
      if (!small) break;
      if (definite_) solution.softest = softest_of_factor();
      return solution.finish(SolveStatus::near_singular);
    }
    const double roughly = rough_step * scale_of(solution);
    if (!obstacles && rough_ && size <= roughly && solution.next_step <= rough_step) {
      return finish();
    }
    const bool goes_on = borrowed && ends_on_own_factor_;
    if (!obstacles && !goes_on && is_at_rounding(solution, size) &&
        solution.next_step <= finest_step) {
      if (borrowed) {
        // Steps with the factor's own Hessian end far below the next one; these only by a part.
        move(solution, 1);
        size = evaluate(solution);
      }
      return finish();
    }
    // Between grips the caller looks at the second variation; without, the factor has to tell it.
    const bool near = moved * (1 + load) <= factor_reach;
    factored = !obstacles && ((near && !prolonged_) || (shrinks && jacobian_.rows() > 0));
  }
  solution.residual = size;
  solution.fail("Newton's method did not reduce the residual to rounding");
}

}  // namespace dlo::energy_model
