#pragma once

#include <Eigen/Core>
#include <memory>

#include "base/deadline.hpp"
#include "base/pool.hpp"
#include "newton/broyden.hpp"
#include "newton/newton_factor.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Forces of grips over 1 + weight and loads beyond which nothing is taken for a shape: residuals
/// are measured against them.
inline constexpr double largest_pull = 1e10;

/// Newton's next step above which a residual that does not fall any more is not
/// taken for a solution [rad].
inline constexpr double coarsest_step = 1e-8;

/// Newton's next step, of which the shape's error is a part, at which it need not go on [rad].
inline constexpr double finest_step = 1e-11;

/// Newton's next step of a shape that is given more terms anyway [rad]: its energy, of
/// which the square is a part, is right to rounding in what tells shapes apart.
inline constexpr double rough_step = 1e-5;

enum class NewtonMethod {
  /// To an equilibrium, stable or not. What is borrowed for the first steps makes room for a factor
  /// of its own before the last ones. Between grips, where it does not converge, once more as the
  /// corrector.
  newton,
  /// Between grips, for a shape next to another one, with whose factor it begins. Where there is
  /// none within a few steps it ends as `failed`, without a second try and without least squares.
  simplified,
  /// For one of many steps along a branch: near-null modes, along which rounding would make any
  /// step, are deflated, so that steps have no part along them.
  corrector,
};

struct NewtonOptions {
  double load = 0;  ///< sum of weight and loads, the scale of the residuals
  NewtonMethod method = NewtonMethod::newton;
  /// Its next step at which it ends [rad]; the residual is at rounding, or as small as that.
  double step_tolerance = finest_step;
  /// Of another shape, for the first steps between grips, if it is of as many unknowns.
  std::shared_ptr<NewtonFactor> first_factor = nullptr;
  /// Likewise, factored with the own constraints' Jacobian.
  const Eigen::MatrixXd* first_hessian = nullptr;
  const Deadline* deadline = nullptr;  ///< beyond, it ends as `time_limit`; null: none
};

/// What newton_solve() works in; buffers survive from one call to the next.
struct NewtonBuffers {
  NewtonFactors factors;
  Pool<SpanPoint> points;
  BroydenSteps broyden;
  std::shared_ptr<SpanPoint> here;  ///< where the solution is
  Eigen::VectorXd gradient;         ///< of E - mu . c there
  Eigen::VectorXd right, step, first_step;
  Eigen::VectorXd trial_x, trial_multipliers, lowest_mode;
  Eigen::MatrixXd near_null_modes;

  [[nodiscard]] std::shared_ptr<SpanPoint> new_point(const SpanEnergy& model) {
    return points.take([&](const SpanPoint& kept) { return kept.x.size() == model.size(); });
  }
};

/// Newton's method on the gradient of E - mu . c and on the constraints: from solution.x to where
/// the residual is at rounding and Newton's next step, evaluated there, is below 1e-8; steps are
/// cut while the next one, with the same factor, is no shorter. Without constraints the Hessian
/// then tells a minimum (`converged`) from a `saddle`; with them the caller has to look. Ends as
/// `near_singular` where the residual is at rounding and the step is not, and as `failed` where the
/// residual does not fall. The solution is left with the last factor of its own, if it has made
/// one. Without constraints and obstacles it allocates nothing once buffers have their size.
void newton_solve(SpanSolution& solution, const NewtonOptions& options, NewtonBuffers& buffers);

}  // namespace dlo::energy_model
