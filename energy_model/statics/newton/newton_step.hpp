#pragma once

#include <memory>

#include "newton/newton.hpp"

namespace dlo::energy_model {

/// Steps of newton_solve(): the factor in use, the solution's own or another shape's, and the step
/// that it gives for gradient and residual. The step is in buffers.step.
class NewtonStep {
 public:
  /// Point at which the factor was computed.
  enum class FactorPoint { nothing, this_point, earlier_point, neighbour };

  /// All arguments have to outlive the object.
  NewtonStep(SpanSolution& solution, const NewtonOptions& options, NewtonBuffers& buffers)
      : solution_(solution), options_(options), buffers_(buffers) {}

  /// Uses the factor given in the options, if there is one of the same size.
  void use_given_factor();
  /// Factors at the present solution.
  void factor();
  [[nodiscard]] FactorPoint factor_point() const { return factor_point_; }
  /// Whether the factor belongs to another shape.
  [[nodiscard]] bool is_borrowed() const { return factor_point_ == FactorPoint::neighbour; }
  /// Keeps the factor for one more step after the solution has moved.
  void reuse() {
    if (!is_borrowed()) factor_point_ = FactorPoint::earlier_point;
  }
  /// Discards the factor, so that the next step gets a factor of its own point.
  void discard_factor() { factor_point_ = FactorPoint::nothing; }

  void solve();
  /// Computes the minimum-norm step.
  void solve_by_least_squares();
  /// Applies Broyden's update to the step that the factor gives after the whole step
  /// buffers.first_step.
  void update();

  /// Returns the norm of the part of the step that moves the unknowns.
  [[nodiscard]] double step_norm() const {
    return buffers_.step.head(buffers_.gradient.size()).norm();
  }
  /// Returns the norm of the step with multipliers, these divided by the scale of forces.
  [[nodiscard]] double norm_with_multipliers() const;

  /// Whether there are no constraints and the factor's Hessian is positive definite.
  [[nodiscard]] bool is_minimum() const {
    return solution_.model->constraints() == 0 && factor_->system.reduced_hessian().is_definite();
  }
  /// Estimates the smallest eigenvalue of the factor's Hessian, for which is_minimum() holds, by
  /// inverse iteration from a vector with components along the low modes. The estimate is not below
  /// the smallest eigenvalue, and close to it if that is far below the others.
  [[nodiscard]] double smallest_eigenvalue();

 private:
  void find_near_null_modes();
  void deflate();

  SpanSolution& solution_;
  const NewtonOptions& options_;
  NewtonBuffers& buffers_;
  std::shared_ptr<NewtonFactor> factor_;
  FactorPoint factor_point_ = FactorPoint::nothing;
};

}  // namespace dlo::energy_model
