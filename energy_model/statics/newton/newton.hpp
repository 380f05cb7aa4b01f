#pragma once

#include <Eigen/Core>
#include <memory>

#include "base/deadline.hpp"
#include "base/pool.hpp"
#include "newton/broyden.hpp"
#include "newton/newton_factor.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Norm of the grips' forces, divided by 1 + weight and loads, above which a result is rejected:
/// residuals are measured relative to the forces.
inline constexpr double largest_pull = 1e10;

/// Length of the next Newton step above which a residual that no longer decreases is not accepted
/// as a solution [rad].
inline constexpr double coarsest_step = 1e-8;

/// Length of the next Newton step at which the iteration ends [rad]; it is a part of the shape's
/// error.
inline constexpr double finest_step = 1e-11;

/// Length of the next Newton step at which the iteration ends for a shape that will get more
/// coefficients anyway [rad]. Its energy error is of the order of the square, so that energies
/// still distinguish shapes.
inline constexpr double rough_step = 1e-5;

enum class NewtonMethod {
  /// Converges to an equilibrium, stable or not. A factor of another shape serves the first steps
  /// only, and is replaced by the shape's own before the last ones. Between grips, an iteration
  /// that
  /// fails is repeated with `corrector`.
  newton,
  /// Converges to an equilibrium near another shape, whose factor serves as the first one; between
  /// grips. If it does not converge within a few steps it ends as `failed`, without a second
  /// attempt and without least squares.
  simplified,
  /// Corrects one of many steps along a branch, with near-null modes deflated: steps have no
  /// component along them, where rounding would determine the length.
  corrector,
};

struct NewtonOptions {
  double load = 0;  ///< weight plus loads, the scale of the residuals
  NewtonMethod method = NewtonMethod::newton;
  /// Length of the next step at which the iteration ends [rad], if the residual is at rounding or
  /// as small as this.
  double step_tolerance = finest_step;
  /// Factor of another shape for the first steps between grips; used if its numbers of unknowns and
  /// constraints are the same.
  std::shared_ptr<NewtonFactor> first_factor = nullptr;
  /// Hessian for the first steps, factored with the shape's own constraint Jacobian; used before
  /// first_factor.
  const Eigen::MatrixXd* first_hessian = nullptr;
  const Deadline* deadline = nullptr;  ///< ends the iteration as `time_limit`; null: none
};

/// Buffers of newton_solve(), kept from one call to the next.
struct NewtonBuffers {
  NewtonFactors factors;
  Pool<SpanPoint> points;
  BroydenSteps broyden;
  std::shared_ptr<SpanPoint> here;  ///< point of the solution
  Eigen::VectorXd gradient;         ///< gradient of E - mu . c there
  Eigen::VectorXd right, step, first_step;
  Eigen::VectorXd trial_x, trial_multipliers, lowest_mode;
  Eigen::MatrixXd near_null_modes;

  [[nodiscard]] std::shared_ptr<SpanPoint> new_point(const SpanEnergy& model) {
    return points.take([&](const SpanPoint& kept) { return kept.x.size() == model.size(); });
  }
};

/// Solves for zero gradient of E - mu . c and zero constraint residuals by Newton's method from
/// solution.x. It ends when the residual is small and the next Newton step, evaluated at the
/// result, is at most NewtonOptions::step_tolerance, or at most coarsest_step if rounding prevents
/// a shorter one. A step is shortened while the next step, with the same factor, is not shorter.
/// Without constraints the Hessian at the end distinguishes a minimum (`converged`) from a
/// `saddle`; with constraints the caller has to examine the second variation. The status is
/// `near_singular` if the residual is at rounding but the step is not, and `failed` if the residual
/// does not decrease. The solution keeps the last factor of its own, if there is one. Without
/// constraints and obstacles nothing is allocated once the buffers have their size.
void newton_solve(SpanSolution& solution, const NewtonOptions& options, NewtonBuffers& buffers);

}  // namespace dlo::energy_model
