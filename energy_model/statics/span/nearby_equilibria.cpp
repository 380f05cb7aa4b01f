#include "span/nearby_equilibria.hpp"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "base/legendre.hpp"
#include "certify/certify.hpp"
#include "certify/rigid_body_modes.hpp"
#include "linear/reduced_hessian.hpp"
#include "span/local_solver.hpp"
#include "span/refinement.hpp"
#include "strain/second_derivatives.hpp"

namespace dlo::energy_model {
namespace {

/// Number of equilibria whose pairs search_between() uses.
constexpr std::size_t most_paired = 6;

constexpr const char* between_found = "between two equilibria found, by Newton's method";
constexpr const char* adjacent_to_found = "adjacent to an equilibrium found, by Newton's method";

/// Returns the solution without its own contact ends, so that it can be combined with another one.
SpanSolution without_own_contact_ends(const SpanSolution& solution, const SpanOptions& options,
                                      SpanWorkspace& workspace) {
  Span span = solution.model->span();
  if (span.contact_ends.empty()) return solution;
  span.contact_ends.clear();
  LocalSolver local_solver(span, options, workspace);
  return fit_to_elements(local_solver, solution, local_solver.coarse_terms());
}

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
  return (solution.at_x()->tangents() - from).cwiseAbs().maxCoeff() < largest_followed_change;
}

/// Solves again from a start near which Newton's method has found nothing, on an adapted mesh for
/// the start's own shape, and by descent if necessary. Returns std::nullopt for a known shape, a
/// span without other grips, if the mesh cannot be adapted, and if no equilibrium is found.
std::optional<SpanSolution> start_on_adapted_mesh(const LocalSolver& on) {
  const SpanStart& start = on.options().start;
  if (start.known.model || on.span().holds.empty()) return std::nullopt;
  SpanSolution fitted = on.empty_solution(max_terms);
  fitted.x = fitted.model->fit(start.field(fitted.model->nodes()));
  const SpanPoint point = fitted.model->evaluated(fitted.x);
  fitted.multipliers = point.jacobian.transpose().householderQr().solve(point.gradient);
  const std::optional<Span> span = adapted_mesh(on, fitted);
  if (!span) return std::nullopt;
  LocalSolver local_solver(*span, on.options(), on.workspace());
  SpanSolution solution = local_solver.newton_from(start.field);
  const int spent = solution.evaluations;
  if (!solution.is_equilibrium()) {
    solution = local_solver.empty_solution(local_solver.terms());
    solution.x = solution.model->fit(start.field(solution.model->nodes()));
    local_solver.descend_to_constraints(solution);
    solution.evaluations += spent;
  }
  solution = refine(local_solver, std::move(solution));
  if (!solution.is_equilibrium()) return std::nullopt;
  return solution;
}

/// Solves with few coefficients or all that the load needs. `followed` is set if Newton's method
/// alone has converged near the known shape.
SpanSolution from_given_start(LocalSolver& on) {
  const SpanStart& start = on.options().start;
  // A descent from the start may precede Newton's method.
  const bool descends = start.approach == Approach::descend || on.options().only_descends();
  SpanSolution solution =
      descends ? on.from_start(Start{start.field}) : on.newton_from(start.field);
  solution.followed = is_followed(solution, start);
  if (succeeded(solution.status) && (solution.followed || !start.known.model)) return solution;
  if (on.options().only_follows()) return solution;
  const bool from_newton = solution.followed;
  std::optional<SpanSolution> other = start_on_adapted_mesh(on);
  if (!other) {
    other = descends ? on.newton_from(start.field) : on.from_start(Start{start.field});
  }
  if (solution.is_equilibrium() && !other->is_equilibrium()) std::swap(solution, *other);
  other->evaluations += solution.evaluations;
  other->followed = from_newton;
  return std::move(*other);
}

/// Returns the unit eigenvector of the eigenvalue of the reduced second variation that is nearest
/// to zero, without rigid-body modes. Returns std::nullopt if the constraints leave no other
/// direction.
std::optional<Eigen::VectorXd> mode_nearest_zero(const SpanSolution& solution) {
  SpanEnergy& model = *solution.model;
  ReducedHessian reduced = reduced_hessian(second_derivatives(solution));
  const Eigen::Index free = rigid_body_modes(model.span(), solution.at_x()->tangents()).in_plane;
  if (free >= model.size() - model.constraints()) return std::nullopt;
  return eigenvector_by_magnitude(reduced, free);
}

}  // namespace

std::optional<NegativeCurvature> negative_curvature(const SpanSolution& solution) {
  SpanEnergy& model = *solution.model;
  if (std::optional<Eigen::VectorXd> within =
          negative_curvature_direction(reduced_hessian(second_derivatives(solution)))) {
    return NegativeCurvature{model.span(), std::move(*within)};
  }
  if (!model.span().planar || model.span().stays_in_plane()) return std::nullopt;
  // Out of the plane u2 is not the rate of the tangent's tilt where the rod is bent: its frame
  // rolls. A model in space is therefore used.
  NegativeCurvature out{model.span(), {}};
  out.span.planar = false;
  SpanEnergy in_space(out.span, solution.terms);
  if (std::optional<Eigen::VectorXd> descent = negative_curvature_direction(
          reduced_hessian(second_derivatives_at(in_space, model, solution.x)))) {
    out.direction = std::move(*descent);
    return out;
  }
  // Deep within a box, midway between two faces, the energy has a ridge: the model in space has one
  // of its slopes there, and only the tilts of the planar model include both.
  const std::optional<Eigen::VectorXd> tilts = negative_curvature_direction(reduced_hessian(
      second_derivatives_out_of_plane(model, *solution.at_x(), solution.multipliers)));
  if (!tilts) return std::nullopt;
  out.direction = Eigen::VectorXd::Zero(model.size() + tilts->size());
  out.direction.tail(tilts->size()) = *tilts;
  return out;
}

std::optional<SpanSolution> leave_saddle(const SpanSolution& solution, const SpanOptions& options,
                                         SpanWorkspace& workspace) {
  const auto descended = [&](const Span& span, const Eigen::VectorXd& disturbance) {
    LocalSolver local_solver(span, options, workspace);
    const std::shared_ptr<SpanEnergy> model = workspace.model(span, solution.terms);
    const Eigen::VectorXd pushed = model->prolong(*solution.model, solution.x) + disturbance;
    SpanSolution lower =
        local_solver.empty_solution(std::min(solution.terms, local_solver.coarse_terms()));
    lower.x = lower.model->prolong(*model, pushed);
    local_solver.descend(lower);
    return refine(local_solver, std::move(lower));
  };
  const std::optional<NegativeCurvature> descent = negative_curvature(solution);
  if (descent) return descended(descent->span, mode_amplitude * descent->direction);
  // A rod through an obstacle's middle is unstable in a mode in which its series does not show it.
  const std::optional<Eigen::VectorXd> mode = mode_nearest_zero(solution);
  if (!mode || solution.model->span().soft_obstacles.empty()) return std::nullopt;
  return descended(solution.model->span(), mode_amplitude * *mode);
}

void search_between(const SpanOptions& options, SpanWorkspace& workspace, Found& found) {
  constexpr std::array<double, 5> shares = {0.2, 0.3, 0.5, 0.7, 0.8};
  for (std::size_t j = 1; j < found.size() && j < most_paired; ++j) {
    for (std::size_t i = 0; i < j && !options.deadline.passed(); ++i) {
      const SpanSolution a = without_own_contact_ends(found[i], options, workspace);
      const SpanSolution b = without_own_contact_ends(found[j], options, workspace);
      const Span& span = a.model->span();
      if (span.planar != b.model->span().planar || span.cuts != b.model->span().cuts) continue;
      LocalSolver local_solver(span, options, workspace);
      // In space steps with all coefficients would dominate the cost of a search; fewer converge to
      // the same equilibria.
      const int all_terms = std::max(a.terms, b.terms);
      const int terms = span.planar ? all_terms : std::min(all_terms, local_solver.coarse_terms());
      for (const double share : shares) {
        SpanSolution between = local_solver.empty_solution(terms);
        SpanEnergy& model = *between.model;
        between.x = (1 - share) * model.prolong(*a.model, a.x);
        between.x += share * model.prolong(*b.model, b.x);
        between.multipliers = (1 - share) * model.prolong_multipliers(*a.model, a.multipliers) +
                              share * model.prolong_multipliers(*b.model, b.multipliers);
        local_solver.newton(between);
        (void)found.add(
            certified_solution(refine(local_solver, std::move(between)), options, workspace),
            between_found);
      }
    }
  }
  if (found.size() > most_paired) {
    options.log->add_omitted("shapes between equilibria found, except for the first " +
                             std::to_string(most_paired));
  }
}

void search_adjacent(const SpanOptions& options, SpanWorkspace& workspace, Found& found) {
  constexpr std::array<double, 6> steps = {0.5, -0.5, 1, -1, 2, -2};
  std::size_t i = 0;
  for (; i < found.size() && i < most_searched_from && !options.deadline.passed(); ++i) {
    if (!is_result(found[i], options)) continue;
    const SpanSolution from = found[i];
    const std::optional<Eigen::VectorXd> mode = mode_nearest_zero(from);
    if (!mode) continue;
    LocalSolver local_solver(from.model->span(), options, workspace);
    for (const double step : steps) {
      SpanSolution displaced = workspace.with_terms(from, from.terms);
      displaced.x += step * *mode;
      local_solver.newton(displaced);
      (void)found.add(
          certified_solution(refine(local_solver, std::move(displaced)), options, workspace),
          adjacent_to_found);
    }
  }
  if (i >= found.size()) return;
  options.log->add_omitted("shapes adjacent to equilibria found, except for the first " +
                           std::to_string(i));
}

SpanSolution solve_from_given_start(const Span& span, const SpanOptions& options,
                                    SpanWorkspace& workspace) {
  LocalSolver on(span, options, workspace);
  SpanSolution solution = from_given_start(on);
  const bool from_newton = solution.followed;
  // A shape on soft obstacles may jump to another one when contact is found during refinement.
  const bool may_descend = from_newton && !span.soft_obstacles.empty();
  const Eigen::Matrix3Xd near = may_descend ? tangents_to_compare(solution) : Eigen::Matrix3Xd();
  solution = finish(std::move(solution), options, workspace);
  solution.followed =
      from_newton && !(may_descend && (tangents_to_compare(solution) - near).cwiseAbs().maxCoeff() >
                                          largest_followed_change);
  const bool leaves =
      (options.only_descends() || (options.start.known.model && !options.only_follows())) &&
      solution.status == SolveStatus::saddle;
  if (!leaves) return solution;
  std::optional<SpanSolution> lower = leave_saddle(solution, options, workspace);
  if (!lower) return solution;
  certify(*lower, workspace.newton());
  lower->evaluations += solution.evaluations;
  return succeeded(lower->status) ? std::move(*lower) : std::move(solution);
}

}  // namespace dlo::energy_model
