#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "base/deadline.hpp"
#include "base/pool.hpp"
#include "linear/reduced_hessian.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Newton's linear system, factored at a point of a span's model. SpanSolution::factor passes it on
/// to later steps, which need no new factorisation.
struct NewtonFactor {
  NewtonSystem system;
  Eigen::VectorXd x, multipliers;  ///< the point
  double scale = 1;                ///< scale of forces there, by which multipliers are divided

  /// Returns the distance of a solution from the point: unknowns, and multipliers divided by the
  /// solution's scale of forces.
  [[nodiscard]] double distance(const SpanSolution& solution) const {
    return (solution.x - x).norm() +
           (solution.multipliers - multipliers).norm() / solution.scale_of_forces();
  }
};

/// Broyden's updates of Newton steps that use the factor of an earlier point. The steps converge
/// superlinearly and cost only products of vectors (Deuflhard, Newton Methods for Nonlinear
/// Problems, algorithm QNERR).
class BroydenSteps {
 public:
  /// Discards the updates; call it after a new factorisation.
  void clear() { count_ = 0; }

  /// Updates the step that the factor gives after the whole step `last`.
  /// @param last          the whole step that was just taken
  /// @param[in,out] next  the step from the factor; on return the updated step
  void update(const Eigen::VectorXd& last, Eigen::VectorXd& next);

 private:
  Eigen::MatrixXd steps_;  // taken since the factorisation, one per column
  Eigen::Index count_ = 0;
};

/// Norm of the multipliers (forces and torques of grips and contacts), divided by 1 + weight and
/// loads, above which a result is rejected: residuals are measured relative to the forces.
inline constexpr double largest_grip_force = 1e10;

/// Length of the next Newton step above which a residual that no longer decreases is not accepted
/// as a solution, and a returned shape is not certified [rad]. The error of the shape's points,
/// divided by the rod length, is about the same.
inline constexpr double largest_stagnation_step = 1e-8;

/// Length of the next Newton step at which the iteration ends [rad]; it is a part of the shape's
/// error.
inline constexpr double default_step_tolerance = 1e-11;

/// Length of the next Newton step at which the iteration ends for a shape that will get more
/// coefficients anyway [rad]. Its energy error is of the order of the square, so that energies
/// still distinguish shapes.
inline constexpr double loose_step_tolerance = 1e-5;

enum class NewtonMethod {
  /// Converges to an equilibrium, stable or not. A factor of another shape serves the first steps
  /// only, and is replaced by the shape's own before the last ones. Between grips, an iteration
  /// that finds no equilibrium within the time limit is repeated with `corrector`.
  newton,
  /// Converges to an equilibrium near another shape, whose factor serves as the first one; between
  /// grips. If it does not converge within a few steps it ends as `failed` or `near_singular`,
  /// without a second attempt. It takes no minimum-norm steps, except where only rounding is left.
  simplified,
  /// Corrects one of many steps along a branch, and is the second attempt of `newton`. Near-null
  /// modes are deflated: steps have no component along them, where rounding would determine the
  /// length.
  corrector,
};

struct NewtonOptions {
  NewtonMethod method = NewtonMethod::newton;
  /// Length of the next step at which the iteration ends [rad], if the residual is at rounding or,
  /// divided by the scale of forces, at most this.
  double step_tolerance = default_step_tolerance;
  /// Factor of another shape for the first steps between grips; used if its numbers of unknowns and
  /// constraints are the same.
  std::shared_ptr<NewtonFactor> first_factor = nullptr;
  Deadline deadline{};  ///< ends the iteration as `time_limit`
};

/// Buffers of newton_solve(), kept from one call to the next. Those of a factor or a point are
/// reused once nobody holds it any more.
struct NewtonBuffers {
  Pool<NewtonFactor> factors;
  Eigen::MatrixXd hessian;  ///< Hessian of the next factor
  Pool<SpanPoint> points;
  BroydenSteps broyden;
  std::shared_ptr<SpanPoint> here;  ///< point of the solution
  Eigen::VectorXd gradient;         ///< gradient of E - mu . c at `here`
  Eigen::VectorXd right, step, first_step;
  Eigen::VectorXd trial_x, trial_multipliers, lowest_mode;
  Eigen::MatrixXd near_null_modes;

  /// Factors the second variation of E - mu . c with the constraints at the solution, and stores
  /// the result in solution.factor.
  /// @param at  point of the model at solution.x
  void factor_at(SpanSolution& solution, SpanPoint& at);
  [[nodiscard]] std::shared_ptr<SpanPoint> new_point(const SpanEnergy& model) {
    return points.take([&](const SpanPoint& kept) { return kept.x.size() == model.size(); });
  }
};

/// Solves for zero gradient of E - mu . c and zero constraint residuals by Newton's method from
/// solution.x. It ends when the residual is small and the next Newton step, evaluated at the
/// result, is at most NewtonOptions::step_tolerance, or at most largest_stagnation_step if rounding
/// prevents a shorter one. A step is shortened while the next step, with the same factor, is not
/// shorter. Without constraints the Hessian at the end distinguishes a minimum (`converged`) from a
/// `saddle`; with constraints the caller has to examine the second variation. The status is
/// `near_singular` if the residual is at rounding but the step is not, and `failed` if the residual
/// does not decrease enough or the multipliers are too large (largest_grip_force). The solution
/// keeps the last factor of its own, if there is one. Without constraints and obstacles nothing is
/// allocated once the buffers have their size.
void newton_solve(SpanSolution& solution, const NewtonOptions& options, NewtonBuffers& buffers);

}  // namespace dlo::energy_model
