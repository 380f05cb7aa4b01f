#include "span/given_start.hpp"

#include <Eigen/QR>
#include <optional>
#include <utility>

#include "base/legendre.hpp"
#include "certify/certify.hpp"
#include "newton/augmented_lagrangian.hpp"
#include "span/local_solver.hpp"
#include "span/nearby_equilibria.hpp"
#include "span/refinement.hpp"

namespace dlo::energy_model {
namespace {

/// Returns tangents of a shape at 65 arc lengths that are the same for every shape.
Eigen::Matrix3Xd tangents_to_compare(const SpanSolution& solution) {
  constexpr Eigen::Index samples = 65;
  const Eigen::VectorXd s = Eigen::VectorXd::LinSpaced(samples, 0, solution.model->span().length);
  return solution.model->shape(solution.x).sample({s.data(), s.data() + samples}).tangents;
}

/// Whether a shape was reached by Newton's method and is near the known one that it started from.
bool is_followed(const SpanSolution& solution, const SpanStart& start) {
  if (!start.known.model || start.approach == Approach::descend || !solution.is_equilibrium()) {
    return false;
  }
  const Eigen::Matrix3Xd from = start.field(solution.model->nodes()).tangents;
  return (solution.at_x()->tangents() - from).cwiseAbs().maxCoeff() < followed_tangents;
}

/// Solves again from a start near which Newton's method has found nothing, on an adapted mesh for
/// the start's own shape, and by descent if necessary.
std::optional<SpanSolution> start_on_adapted_mesh(const LocalSolver& on) {
  const SpanStart& start = on.options().start;
  if (start.known.model || on.span().holds.empty()) return std::nullopt;
  SpanSolution looked = on.empty_solution(max_terms);
  looked.x = looked.model->fit(start.field(looked.model->nodes()));
  const SpanPoint point = looked.model->evaluated(looked.x);
  looked.multipliers = point.jacobian.transpose().householderQr().solve(point.gradient);
  const std::optional<Span> span = adapted_mesh(on, looked);
  if (!span) return std::nullopt;
  LocalSolver own(*span, on.options(), on.workspace());
  SpanSolution solution = own.newton_from(start.field);
  const int spent = solution.evaluations;
  if (!solution.is_equilibrium()) {
    solution = own.empty_solution(own.terms());
    solution.x = solution.model->fit(start.field(solution.model->nodes()));
    descend_by_augmented_lagrangian(solution, {.load = own.traits().load,
                                               .deadline = &on.options().deadline,
                                               .stiffness = own.traits().stiffness});
    if (succeeded(solution.status)) own.newton(solution);
    solution.evaluations += spent;
  }
  solution = refined(own, std::move(solution));
  if (!solution.is_equilibrium()) return std::nullopt;
  return solution;
}

/// Solves with few coefficients or all that the load needs. `followed` is set if Newton's method
/// alone has converged near the known shape.
SpanSolution from_given_start(LocalSolver& on) {
  const SpanStart& start = on.options().start;
  const bool descends = on.options().descends();
  SpanSolution solution =
      descends ? on.from_start(Start{start.field}) : on.newton_from(start.field);
  solution.followed = is_followed(solution, start);
  if (succeeded(solution.status) && (solution.followed || !start.known.model)) return solution;
  if (on.options().only_follows()) return solution;
  const int spent = solution.evaluations;
  const bool came_by_newton = solution.followed;
  std::optional<SpanSolution> other = start_on_adapted_mesh(on);
  if (!other) {
    other = descends ? on.newton_from(start.field) : on.from_start(Start{start.field});
  }
  other->evaluations += spent;
  other->followed = came_by_newton;
  return std::move(*other);
}

}  // namespace

SpanSolution solve_from_given_start(const Span& span, const SpanOptions& options,
                                    SpanWorkspace& workspace) {
  LocalSolver on(span, options, workspace);
  SpanSolution solution = from_given_start(on);
  const bool came_by_newton = solution.followed;
  // A shape on soft obstacles may jump to another one when contact is found during refinement.
  const bool may_fall = came_by_newton && !span.soft_obstacles.empty();
  const Eigen::Matrix3Xd near = may_fall ? tangents_to_compare(solution) : Eigen::Matrix3Xd();
  solution = finish(std::move(solution), options, workspace);
  solution.followed =
      came_by_newton && !(may_fall && (tangents_to_compare(solution) - near).cwiseAbs().maxCoeff() >
                                          followed_tangents);
  const bool leaves =
      (options.only_descends() || (options.start.known.model && !options.only_follows())) &&
      solution.status == SolveStatus::saddle;
  if (!leaves) return solution;
  std::optional<SpanSolution> lower = leave_saddle(solution, options, workspace);
  if (!lower) return solution;
  certify(*lower, on.traits().load, workspace.factors());
  lower->evaluations += solution.evaluations;
  return succeeded(lower->status) ? std::move(*lower) : std::move(solution);
}

}  // namespace dlo::energy_model
