#include "newton/newton.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "newton/newton_step.hpp"

namespace dlo::energy_model {
namespace {

/// Residual, relative to the scale of forces, up to which it may consist of rounding errors.
constexpr double rounding_residual = 1e-8;

/// Contraction rate of steps with a factor of another point up to which that factor is kept.
constexpr double fast_contraction = 0.1;

/// Maximum numbers of steps: in general, and for NewtonMethod::simplified.
constexpr int most_newton_steps = 30;
constexpr int most_simplified_steps = 10;
/// Longest step of NewtonMethod::simplified with a factor of its own [rad].
constexpr double longest_simplified_step = 10;
/// Step at which a factor of another shape is replaced by the shape's own [rad]: the next step,
/// about the square of this one, is at rounding.
constexpr double borrowed_factor_step = 1e-6;

/// Largest step, times 1 + load, after which the factor is reused: the residual still decreases by
/// about this factor.
constexpr double factor_reuse_step = 1e-3;

class NewtonIteration {
 public:
  NewtonIteration(SpanSolution& solution, const NewtonOptions& options, NewtonBuffers& buffers)
      : solution_(solution),
        options_(options),
        model_(*solution.model),
        buffers_(buffers),
        step_(solution, options, buffers) {}

  void run() {
    begin();
    iterate();
    solution_.residual = residual_norm_;
    solution_.point = std::move(buffers_.here);
  }

 private:
  enum class Outcome { continues, equilibrium, singular, diverged };

  void iterate() {
    const int most =
        options_.method == NewtonMethod::simplified ? most_simplified_steps : most_newton_steps;
    for (int step = 0; step < most && std::isfinite(residual_norm_); ++step) {
      if (options_.deadline.passed()) return solution_.finish(SolveStatus::time_limit);
      const Outcome outcome = advance();
      if (outcome == Outcome::equilibrium) return finish();
      if (outcome == Outcome::singular) {
        if (step_.is_minimum()) solution_.eigenvalue_nearest_zero = step_.smallest_eigenvalue();
        return solution_.finish(SolveStatus::near_singular);
      }
      if (outcome == Outcome::diverged) break;
    }
    solution_.fail("Newton's method did not reduce the residual to rounding");
  }

  void begin() {
    buffers_.broyden.clear();
    solution_.factor.reset();
    buffers_.here = buffers_.new_point(model_);
    trial_ = buffers_.new_point(model_);
    if (solution_.has_point()) {
      *buffers_.here = *solution_.point;
    } else {
      solution_.evaluate(solution_.x, *buffers_.here);
    }
    if (solution_.multipliers.size() != model_.constraints()) {
      solution_.multipliers.setZero(model_.constraints());
      // Least-squares multipliers, which minimise the residual of the gradient.
      if (model_.constraints() > 0) {
        solution_.multipliers =
            buffers_.here->jacobian.transpose().householderQr().solve(buffers_.here->gradient);
      }
    }
    residual_norm_ = residual();
    const bool can_borrow = model_.constraints() > 0 && options_.method != NewtonMethod::corrector;
    if (can_borrow) step_.use_given_factor();
  }

  /// Computes the norm of the residual of gradient and constraints at the present point, the latter
  /// multiplied by 1 + load. Also sets the solution's energy and buffers_.gradient.
  [[nodiscard]] double residual() {
    const SpanPoint& here = *buffers_.here;
    solution_.energy = here.energy;
    buffers_.gradient = here.gradient;
    if (model_.constraints() == 0) return here.gradient.norm();
    buffers_.gradient.noalias() -= here.jacobian.transpose() * solution_.multipliers;
    return std::hypot(buffers_.gradient.norm(), (1 + model_.load()) * here.residual.norm());
  }

  [[nodiscard]] Outcome advance() {
    if (step_.factor_point() == NewtonStep::FactorPoint::nothing) {
      step_.factor();
      step_is_next_ = false;
    }
    if (!std::exchange(step_is_next_, false)) step_.solve();
    const bool ends_on_own = options_.method != NewtonMethod::simplified;
    if (step_.is_borrowed() && ends_on_own && step_.step_norm() <= borrowed_factor_step) {
      step_.factor();
      step_.solve();
    }
    const double moved = step_.step_norm();
    solution_.next_step = moved;
    if (!ends_on_own && !step_.is_borrowed() && !(moved <= longest_simplified_step)) {
      return Outcome::diverged;
    }
    if (moved <= default_step_tolerance && is_at_rounding()) return Outcome::equilibrium;
    return natural_monotonicity_step() ? handle_accepted_step(moved) : handle_rejected_step(moved);
  }

  /// Decides what to do after a step that no shortening made acceptable and that has been undone.
  [[nodiscard]] Outcome handle_rejected_step(double moved) {
    const bool small = is_at_rounding();
    const bool is_own = step_.factor_point() == NewtonStep::FactorPoint::this_point;
    // Only rounding is left; its component along a near-null mode has no meaning.
    if (small && moved > largest_stagnation_step && !step_.is_minimum() && is_own) {
      step_.solve_by_least_squares();
      solution_.next_step = step_.step_norm();
    }
    if (small && solution_.next_step <= largest_stagnation_step && !step_.is_borrowed()) {
      return Outcome::equilibrium;
    }
    if (!is_own || options_.deadline.passed()) {
      step_.discard_factor();
      return Outcome::continues;
    }
    return small ? Outcome::singular : Outcome::diverged;
  }

  [[nodiscard]] Outcome handle_accepted_step(double moved) {
    step_is_next_ = true;
    solution_.next_step = step_.step_norm();
    const bool borrowed = step_.is_borrowed();
    const bool continues = borrowed && options_.method != NewtonMethod::simplified;
    const double small =
        std::max(rounding_residual, options_.step_tolerance) * solution_.scale_of_forces();
    if (!continues && residual_norm_ <= small && solution_.next_step <= options_.step_tolerance) {
      if (borrowed) {
        // With the factor's own Hessian the error after the last step is far below the next step;
        // with a borrowed factor it is only a fraction of it.
        move(1);
        residual_norm_ = evaluated_residual();
      }
      return Outcome::equilibrium;
    }
    // With constraints the caller examines the second variation, so that a factor from farther away
    // may be kept. Without constraints the factor itself shows whether the Hessian is positive
    // definite.
    // A yielding obstacle that is touched or left changes the Hessian within any distance.
    const bool near =
        moved * (1 + model_.load()) <= factor_reuse_step && !model_.has_soft_obstacles();
    const bool shrinks = solution_.next_step < fast_contraction * moved && model_.constraints() > 0;
    near || shrinks ? step_.reuse() : step_.discard_factor();
    return Outcome::continues;
  }

  void finish() {
    solution_.eigenvalue_nearest_zero =
        step_.is_minimum() ? step_.smallest_eigenvalue() : std::numeric_limits<double>::quiet_NaN();
    if (!(solution_.multipliers.norm() <= largest_grip_force * (1 + model_.load()))) {
      return solution_.fail("Newton's method diverged to unbounded forces");
    }
    const bool minimum = step_.is_minimum() || model_.constraints() > 0;
    solution_.finish(minimum ? SolveStatus::converged : SolveStatus::saddle);
  }

  void move(double length) {
    solution_.x += length * buffers_.step.head(buffers_.gradient.size());
    if (model_.constraints() > 0) {
      solution_.multipliers += length * buffers_.step.tail(model_.constraints());
    }
  }

  /// Moves along the step, shortened by factors of 4 until the next step with the same factor is
  /// shorter (Deuflhard's natural monotonicity test, which does not depend on the relative scale of
  /// gradient and constraints). The next step is left in buffers_.step, the residual in
  /// residual_norm_. With constraints the next step is Broyden's, from all whole steps with this
  /// factor.
  /// @return whether such a length was found; if not, the solution is unchanged
  [[nodiscard]] bool natural_monotonicity_step() {
    constexpr double longest_newton_step = 2;  // largest step [rad]; longer ones leave the path
    constexpr double least_part = 1e-5;        // smallest part of a step
    std::swap(buffers_.here, trial_);
    buffers_.trial_x = solution_.x;
    buffers_.trial_multipliers = solution_.multipliers;
    buffers_.first_step = buffers_.step;
    const double length = step_.norm_with_multipliers();
    const double moves = step_.step_norm();
    const double first = std::min(1.0, longest_newton_step / moves);
    // So short a step is not shortened: if the next one is no shorter, both consist of rounding
    // errors.
    const bool short_enough = moves <= largest_stagnation_step && is_at_rounding();
    const double least = short_enough ? first / 2 : least_part;
    for (double part = first; part > least && !options_.deadline.passed(); part /= 4) {
      buffers_.step = buffers_.first_step;
      move(part);
      residual_norm_ = evaluated_residual();
      if (std::isfinite(residual_norm_)) {
        step_.solve();
        if (step_.norm_with_multipliers() < (1 - part / 4) * length) {
          // A shortened or deflated step is no valid secant for Broyden's update.
          if (part < 1 || options_.method == NewtonMethod::corrector) {
            buffers_.broyden.clear();
          } else if (model_.constraints() > 0) {
            step_.update();
          }
          return true;
        }
      }
      solution_.x = buffers_.trial_x;
      solution_.multipliers = buffers_.trial_multipliers;
    }
    buffers_.step = buffers_.first_step;
    std::swap(buffers_.here, trial_);
    residual_norm_ = residual();
    return false;
  }

  [[nodiscard]] double evaluated_residual() {
    solution_.evaluate(solution_.x, *buffers_.here);
    return residual();
  }

  /// Whether the residual may consist of rounding errors.
  [[nodiscard]] bool is_at_rounding() const {
    return residual_norm_ <= rounding_residual * solution_.scale_of_forces();
  }

  SpanSolution& solution_;
  const NewtonOptions& options_;
  const SpanEnergy& model_;
  NewtonBuffers& buffers_;
  NewtonStep step_;
  bool step_is_next_ = false;  // buffers_.step is already the step from the present point
  double residual_norm_ = 0;
  std::shared_ptr<SpanPoint> trial_;
};

}  // namespace

void newton_solve(SpanSolution& solution, const NewtonOptions& options, NewtonBuffers& buffers) {
  if (options.method != NewtonMethod::newton || solution.model->constraints() == 0) {
    return NewtonIteration(solution, options, buffers).run();
  }
  const Eigen::VectorXd x = solution.x;
  const Eigen::VectorXd multipliers = solution.multipliers;
  NewtonIteration(solution, options, buffers).run();
  if (solution.is_equilibrium() || solution.status == SolveStatus::time_limit) return;
  solution.x = x;
  solution.multipliers = multipliers;
  NewtonOptions corrector = options;
  corrector.method = NewtonMethod::corrector;
  NewtonIteration(solution, corrector, buffers).run();
}

}  // namespace dlo::energy_model
