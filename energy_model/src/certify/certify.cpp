#include "certify/certify.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/free_directions.hpp"
#include "newton/newton.hpp"

namespace dlo::energy_model {
namespace {

/// Newton's step that a returned shape may have left; its points are then right to about as much of
/// the rod's length.
constexpr double largest_next_step = 1e-8;

/// Norm of Newton's step from here; in neutral directions it stands still.
double newton_step(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian,
                   const Eigen::VectorXd& gradient, const Eigen::VectorXd& residual) {
  const Eigen::Index n = hessian.rows();
  const Eigen::Index m = jacobian.rows();
  Eigen::MatrixXd system(n + m, n + m);
  system << hessian, jacobian.transpose(), jacobian, Eigen::MatrixXd::Zero(m, m);
  Eigen::VectorXd right(n + m);
  right << -gradient, -residual;
  Eigen::VectorXd step = system.partialPivLu().solve(right);
  if (!((system * step - right).norm() <= 1e-6 * right.norm()) ||
      !(step.head(n).norm() <= largest_next_step)) {
    step = newton_step_across_neutral(system, right);
  }
  return step.head(n).norm();
}

}  // namespace

void certify(SpanSolution& solution, double load) {
  if (!solution.is_equilibrium()) return;
  SpanEnergy& model = *solution.model;
  Eigen::VectorXd gradient(model.size());
  solution.energy = model.value(solution.x, gradient);
  ++solution.evaluations;
  Eigen::MatrixXd hessian;
  Eigen::MatrixXd jacobian(model.constraints(), model.size());
  Eigen::VectorXd residual(model.constraints());
  model.constraint(residual, jacobian);
  model.hessian(solution.multipliers, hessian);
  gradient -= jacobian.transpose() * solution.multipliers;
  if (!(solution.multipliers.norm() <= largest_pull * (1 + load))) {
    return solution.fail("the grips would have to pull without bound");
  }
  const double scale = 1 + load + solution.multipliers.norm();
  solution.residual = std::hypot(gradient.norm(), scale * residual.norm());
  // With rigid walls the multipliers have moved on since; how far the shape is behind them is told
  // apart.
  if (!model.has_walls() && !(solution.residual <= largest_next_step * scale)) {
    return solution.fail("the residual of the returned shape is not small");
  }
  if (!model.has_walls()) {
    solution.next_step = newton_step(hessian, jacobian, gradient, residual);
    if (!(solution.next_step <= largest_next_step))
      return solution.finish(SolveStatus::near_singular);
  }
  solution.smallest_curvature = smallest_eigenvalue(hessian, jacobian);
  if (model.span().planar) {
    model.sideways(solution.multipliers, hessian, jacobian);
    solution.smallest_curvature =
        std::min(solution.smallest_curvature, smallest_eigenvalue(hessian, jacobian));
  }
  solution.finish(solution.smallest_curvature < -neutral ? SolveStatus::saddle
                                                         : SolveStatus::converged);
}

void certify_sideways(SpanSolution& solution) {
  if (solution.status != SolveStatus::converged) return;
  if (!solution.model->resists_sideways()) solution.finish(SolveStatus::saddle);
}

}  // namespace dlo::energy_model
