#pragma once

#include <memory>

#include "newton/newton.hpp"

namespace dlo::energy_model {

/// Steps of newton_solve(): a factor, its own or another shape's, and what it makes of gradient and
/// residual. All of them are buffers.step.
class NewtonStep {
 public:
  /// What the factor is of.
  enum class FactorOf { nothing, this_point, earlier_point, neighbour };

  /// All of them have to outlive it.
  NewtonStep(SpanSolution& solution, const NewtonOptions& options, NewtonBuffers& buffers)
      : solution_(solution), options_(options), buffers_(buffers) {}

  /// Takes the factor that the options bring along, if they do.
  void borrow();
  /// Factors where the solution is.
  void factor();
  [[nodiscard]] FactorOf factor_of() const { return factor_of_; }
  /// Whether it is another shape's.
  [[nodiscard]] bool is_borrowed() const { return factor_of_ == FactorOf::neighbour; }
  /// The solution has moved on, and its factor serves one more step.
  void reuse() {
    if (!is_borrowed()) factor_of_ = FactorOf::earlier_point;
  }
  /// The next step is to have a factor of its own point.
  void give_up_factor() { factor_of_ = FactorOf::nothing; }

  void solve();
  /// The minimum-norm step.
  void solve_by_least_squares();
  /// Broyden's, of the step that the factor gives after the whole step buffers.first_step.
  void update();

  /// Of the step, what moves the unknowns.
  [[nodiscard]] double size() const { return buffers_.step.head(buffers_.gradient.size()).norm(); }
  /// The same with multipliers, by their own size.
  [[nodiscard]] double size_with_forces() const;

  /// Whether no constraints bind it, and the factor's Hessian is positive definite.
  [[nodiscard]] bool is_minimum() const {
    return solution_.model->constraints() == 0 && factor_->system.reduced_hessian().is_definite();
  }
  /// Of that Hessian, by inverse iteration from a vector that low modes share: not below the
  /// smallest eigenvalue, and next to it where that is far below the others.
  [[nodiscard]] double smallest_eigenvalue();

 private:
  void find_near_null_modes();
  void deflate();

  SpanSolution& solution_;
  const NewtonOptions& options_;
  NewtonBuffers& buffers_;
  std::shared_ptr<NewtonFactor> factor_;
  FactorOf factor_of_ = FactorOf::nothing;
};

}  // namespace dlo::energy_model
