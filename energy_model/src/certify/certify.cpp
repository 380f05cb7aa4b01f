#include "certify/certify.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/free_directions.hpp"
#include "certify/free_turns.hpp"
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
    step = AcrossNeutral(system).step(right);
  }
  return step.head(n).norm();
}

/// Of forces.
double scale_of(const SpanSolution& solution, double load) {
  return 1 + load + solution.multipliers.norm();
}

/// Rounding of forces, whose scale is this.
double rounding_of(double scale) { return 8 * std::numeric_limits<double>::epsilon() * scale; }

/// What the points of a shape may be away from those of an equilibrium, of the length: what
/// Newton's method would still move them by, and what rounding and the modes that are left out push
/// along the softest direction. The coefficients of strains bound what positions move by; no point
/// of a held rod can be off by more than twice its length. NaN with soft obstacles, which make
/// kinks inside pieces.
double error_estimate(const SpanSolution& solution, double load) {
  const SpanEnergy& model = *solution.model;
  if (model.has_soft_obstacles()) return std::numeric_limits<double>::quiet_NaN();
  const double scale = scale_of(solution, load);
  // The angle that the last coefficient adds is a_K / (2K); forces feel it as little again.
  const double K = solution.terms;
  const double angle = model.tail(solution.x) / (2 * K);
  const double softest = std::min(solution.softest, 1.0);
  // The unit is the rod's smaller bending stiffness.
  double softest_section = 1;
  for (const Span::Part& part : model.span().parts) {
    softest_section = std::min(softest_section, part.stiffness.head<2>().minCoeff());
  }
  const double moved =
      (solution.next_step + (rounding_of(scale) + scale * angle / (2 * K)) / softest) /
      std::sqrt(softest_section);
  return std::min(moved + angle, 2.0);
}

/// Eigenvalues of the second variation in some directions, as far as they were looked at.
struct Softness {
  double smallest = 0;         // eigenvalue
  double nearest_zero = 0;     // size of the eigenvalue nearest to zero that is no free turn's
  int neutral_directions = 0;  // that are no free turns
};

/// @param bound    size up to which an eigenvalue counts as neutral
/// @param free     turns of the rod as a whole, whose eigenvalues are zero
/// @param nothing  size up to which one is zero whatever its direction is; negative: none is
Softness softness(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian, double bound,
                  Eigen::Index free, double nothing) {
  Softness result;
  result.smallest = smallest_eigenvalue(hessian, jacobian);
  result.nearest_zero = std::abs(result.smallest);
  // A factor proves that none is much smaller than a smallest one that is positive.
  if (result.smallest > 2 * bound) return result;
  const Eigen::VectorXd sizes = eigenvalues_by_size(hessian, jacobian).cwiseAbs();
  const Eigen::Index zero = std::max(std::min(free, (sizes.array() <= bound).count()),
                                     (sizes.array() <= nothing).count());
  result.neutral_directions = static_cast<int>((sizes.array() <= bound).count() - zero);
  result.nearest_zero = zero < sizes.size() ? sizes[zero] : 1;
  return result;
}

}  // namespace

void certify(SpanSolution& solution, double load) {
  // Newton's method leaves those undetermined whose terms nobody has looked at.
  const bool undetermined = solution.status == SolveStatus::near_singular;
  if (!solution.is_equilibrium() && !undetermined) return;
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
  const double scale = scale_of(solution, load);
  solution.residual = std::hypot(gradient.norm(), scale * residual.norm());
  if (!(solution.residual <= largest_next_step * scale)) {
    return solution.fail("the residual of the returned shape is not small");
  }
  solution.next_step = newton_step(hessian, jacobian, gradient, residual);
  const bool small_step = solution.next_step <= largest_next_step;
  // Below it what is left of the residual makes a step that is not small.
  const double bound = std::max(neutral, small_step ? 0 : solution.residual / largest_next_step);
  const FreeTurns free = free_turns(model.span(), model.tangents());
  // Obstacles leave movements free that are not looked for: those that are zero but for rounding.
  const bool obstacles = model.has_soft_obstacles() || !model.span().contacts.empty();
  const double nothing = obstacles ? 128 * rounding_of(scale) : -1;
  Softness found = softness(hessian, jacobian, bound, free.in_plane, nothing);
  solution.smallest_curvature = found.smallest;
  solution.softest = found.nearest_zero;
  solution.error = error_estimate(solution, load);
  solution.neutral_directions = found.neutral_directions;
  if (model.span().planar) {
    model.sideways(solution.multipliers, hessian, jacobian);
    found = softness(hessian, jacobian, bound, free.sideways, nothing);
    solution.smallest_curvature = std::min(solution.smallest_curvature, found.smallest);
    solution.neutral_directions += found.neutral_directions;
  }
  if (undetermined || !small_step) return solution.finish(SolveStatus::near_singular);
  if (solution.smallest_curvature < -neutral) return solution.finish(SolveStatus::saddle);
  solution.finish(solution.neutral_directions > 0 ? SolveStatus::near_singular
                                                  : SolveStatus::converged);
}

void certify_sideways(SpanSolution& solution, double load) {
  const bool unsure = solution.is_equilibrium() && solution.softest <= neutral;
  if (unsure || solution.status == SolveStatus::near_singular) return certify(solution, load);
  if (!solution.is_equilibrium()) return;
  solution.error = error_estimate(solution, load);
  if (solution.status != SolveStatus::converged) return;
  if (!solution.model->resists_sideways()) solution.finish(SolveStatus::saddle);
}

}  // namespace dlo::energy_model
