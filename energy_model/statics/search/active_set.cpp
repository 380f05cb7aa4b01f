#include "search/active_set.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "certify/piece_cuts.hpp"
#include "contact/clearance.hpp"
#include "newton/trust_region.hpp"
#include "search/free_boundary.hpp"
#include "span/local_solver.hpp"
#include "span/refinement.hpp"

namespace dlo::energy_model {
namespace {

/// Number of unknowns above which half of the coefficients for the load are tried first.
constexpr int many_unknowns = 300;
/// First trust-region radius of a descent near soft obstacles: a longer step (roughly in rad) would
/// take the rod to their other side.
constexpr double careful_radius = 0.05;
/// Length, divided by the span's length, below which a part in contact becomes a point; the next
/// update checks whether the rod is within the obstacle next to it.
constexpr double shortest_contact_part = 1e-3;

/// Whether the contacts end where an obstacle without friction requires, which makes the shape an
/// equilibrium: a remaining slope or moment there would need more than pressure.
bool meets_free_boundaries(const SpanSolution& solution) {
  constexpr double contact_residual_tolerance = 1e-6;
  const Span& span = solution.model->span();
  const std::vector<FreeBoundary> ends = free_boundaries(span);
  if (ends.empty()) return true;
  const Eigen::VectorXd residual = free_boundary_residual(solution, ends);
  if (!(residual.cwiseAbs().maxCoeff() <= contact_residual_tolerance)) return false;
  // The positions of two points determine how they share a force, and need a stricter tolerance.
  constexpr double share = 1e-7;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (span.contacts[ends[i].contact].lies()) continue;
    const MoveLimits limits = move_limits(span, ends[i]);
    const double error = std::abs(residual[static_cast<Eigen::Index>(i)]);
    if (!(error <= share * std::min(limits.down, limits.up))) return false;
  }
  return true;
}

/// Solves for the equilibrium with the known contacts, by Newton's method from the known shape.
/// Returns an empty solution if the known shape has another number of elements.
SpanSolution solve_near_known(const Span& span, const SpanOptions& options,
                              SpanWorkspace& workspace) {
  const KnownShape& known = options.start.known;
  SpanSolution solution = workspace.empty_solution(span, known.model->terms());
  SpanEnergy& model = *solution.model;
  if (model.elements() != known.model->elements()) return {};
  const bool fits = span.planar || span.has_material_directors();
  // The fit also determines the winding of the clamps.
  solution.x =
      fits ? model.fit(options.start.field(model.nodes())) : model.prolong(*known.model, known.x);
  // A part that becomes short has fewer multipliers.
  if (known.multipliers.size() == model.constraints()) solution.multipliers = known.multipliers;
  newton_solve(solution, {.deadline = options.deadline}, workspace.newton());
  return solution;
}

/// Fixes contacts at points: where an obstacle would have to pull, there may be no equilibrium with
/// a sliding contact but one with a fixed contact. A very short part in contact becomes a point.
/// @return whether any sliding contact at a point has been fixed
[[nodiscard]] bool fix_contact_points(Span& span) {
  bool any = false;
  for (Span::Contact& contact : span.contacts) {
    const bool inside = contact.begin > 0 && contact.end < span.length;
    const double middle = (contact.begin + contact.end) / 2;
    if (contact.lies() && inside &&
        contact.end - contact.begin < shortest_contact_part * span.length) {
      contact.begin = contact.end = middle;
    }
    any = any || (contact.slides && !contact.lies());
    contact.slides = false;
  }
  return any;
}

}  // namespace

SpanSolution ActiveSet::solve(Span span, TangentField near) {
  return with_evaluations(run(std::move(span), std::move(near), {}, Resolution::resolved));
}

SpanSolution ActiveSet::solve(SpanSolution equilibrium) {
  Span span = equilibrium.model->span();
  return with_evaluations(run(std::move(span), {}, std::move(equilibrium), Resolution::resolved));
}

SpanSolution ActiveSet::update(SpanSolution equilibrium) {
  Span span = equilibrium.model->span();
  least_terms_ = equilibrium.terms;
  return with_evaluations(run(std::move(span), {}, std::move(equilibrium), Resolution::coarse));
}

/// Runs the rounds of the active-set method. @param solution  first iterate, with its contacts, if
/// it is an equilibrium; otherwise `near` is used
SpanSolution ActiveSet::run(Span span, TangentField near, SpanSolution solution,
                            Resolution resolution) {
  spent_ += std::exchange(solution.evaluations, 0);
  for (int round = 0; round < most_contact_rounds; ++round) {
    const bool found_already = round == 0 && solution.is_equilibrium();
    if (!found_already) solution = newton_from(span, near);
    if (!solution.is_equilibrium() && fix_contact_points(span)) solution = newton_from(span, near);
    if (!solution.is_equilibrium()) break;
    spent_ += free_boundary_newton(solution, options_.deadline, workspace_);
    std::optional<std::vector<Span::Contact>> next = updated_contacts(solution, Resolution::coarse);
    if (!next && resolution == Resolution::coarse) return solution;
    if (!next) {
      solution = resolved(std::move(solution), span);
      if (!solution.is_equilibrium()) break;
      next = updated_contacts(solution, Resolution::resolved);
      if (!next && !meets_free_boundaries(solution)) break;
      if (!next) return solution;
    }
    near = solution.model->field(solution.x);
    span = solution.model->span();
    span.contacts = std::move(*next);
    for (Span::Contact& contact : span.contacts) contact.slides = true;
  }
  const std::string why = solution.is_equilibrium() ? "" : ": " + solution.message;
  solution.finish(options_.deadline.passed() ? SolveStatus::time_limit : SolveStatus::not_verified);
  solution.message += ": the contacts did not converge" + why;
  return solution;
}

SpanSolution ActiveSet::newton_from(const Span& span, const TangentField& near) {
  const int terms =
      options_.terms > 0 ? options_.terms : std::max(terms_of_load(span), least_terms_);
  SpanSolution solution = workspace_.empty_solution(span, terms);
  solution.x = solution.model->fit(near(solution.model->nodes()));
  const Eigen::VectorXd start = solution.x;
  const NewtonOptions newton = {.deadline = options_.deadline};
  // Newton's method would return to the saddle, or to the plane, that a shape has left.
  const bool has_left =
      options_.start.approach == Approach::descend || span.planar != searched_.planar;
  if (!has_left) newton_solve(solution, newton, workspace_.newton());
  if (!solution.is_equilibrium()) {
    solution.x = start;
    const bool may_skip_kinks = has_left && !span.soft_obstacles.empty();
    descend_in_trust_region(solution, {.radius = may_skip_kinks ? careful_radius : first_radius,
                                       .deadline = options_.deadline});
    if (succeeded(solution.status)) newton_solve(solution, newton, workspace_.newton());
  }
  spent_ += std::exchange(solution.evaluations, 0);
  return solution;
}

int ActiveSet::terms_of_load(const Span& span) {
  constexpr int least_count = 12;  // next to a kink
  const std::vector<Element> elements = elements_of(span);
  const int count =
      std::max(least_count, first_terms(span.total_load(), longest_element(elements)));
  // Many elements are short and need fewer coefficients while contacts change.
  const int unknowns = count * static_cast<int>(elements.size()) * (span.planar ? 1 : 2);
  return unknowns > many_unknowns ? std::max(least_count, count / 2) : count;
}

/// Resolves an equilibrium with all coefficients. If two contact points are about to become a part,
/// neither slides with a minimum of the gap; they are then fixed at their positions.
/// @param span  on return that of the result
SpanSolution ActiveSet::resolved(SpanSolution solution, Span& span) {
  const TangentField here = solution.model->field(solution.x);
  span = solution.model->span();
  solution = with_all_terms(std::move(solution));
  if (solution.is_equilibrium() || !fix_contact_points(span)) return solution;
  solution = newton_from(span, here);
  return solution.is_equilibrium() ? with_all_terms(std::move(solution)) : solution;
}

/// Adds coefficients until the shape is resolved and parts in contact are on their obstacles;
/// certifies the result.
SpanSolution ActiveSet::with_all_terms(SpanSolution solution) {
  for (;;) {
    const int before = solution.terms;
    solution = finished(std::move(solution));
    if (solution.is_equilibrium() && solution.terms > before) {
      spent_ += free_boundary_newton(solution, options_.deadline, workspace_);
      solution = finished(std::move(solution));
    }
    const int finer = solution.terms + solution.terms / 2;
    const bool more = options_.terms == 0 && finer <= max_terms && is_within_truncation(solution);
    if (!more || options_.deadline.passed()) return solution;
    SpanSolution next = workspace_.with_terms(solution, finer);
    newton_solve(next, {.deadline = options_.deadline}, workspace_.newton());
    if (!next.is_equilibrium()) return solution;
    solution = std::move(next);
    spent_ += free_boundary_newton(solution, options_.deadline, workspace_);
  }
}

/// Whether the rod is within an obstacle, by no more than truncation explains.
bool ActiveSet::is_within_truncation(const SpanSolution& solution) const {
  if (!solution.is_equilibrium()) return false;
  const std::vector<GapMinimum> behind = gap_minima(searched_, solution.model->shape(solution.x),
                                                    -contact_tolerance * searched_.length);
  return !behind.empty() && std::ranges::all_of(behind, [&](const auto& lowest) {
    return lowest.clearance > -coarse_contact_tolerance * searched_.length;
  });
}

SpanSolution ActiveSet::finished(SpanSolution solution) {
  SpanOptions options = options_;
  options.start = {};
  solution = finish(std::move(solution), options, workspace_);
  spent_ += std::exchange(solution.evaluations, 0);
  return solution;
}

SpanSolution ActiveSet::with_evaluations(SpanSolution solution) {
  solution.evaluations = std::exchange(spent_, 0);
  return solution;
}

std::optional<std::vector<Span::Contact>> moved_contacts(const Span& span,
                                                         std::vector<Span::Contact> known) {
  for (Span::Contact& contact : known) {
    const auto moved =
        std::ranges::find(span.rigid_obstacles, contact.obstacle.index, &Span::Obstacle::index);
    if (moved == span.rigid_obstacles.end()) return std::nullopt;
    contact.obstacle = *moved;
    contact.slides = true;
  }
  return known;
}

SpanSolution follow_contacts(const Span& searched, const SpanOptions& options,
                             SpanWorkspace& workspace) {
  const SpanStart& start = options.start;
  ActiveSet active_set(searched, options, workspace);
  Span span = searched;
  span.planar = searched.planar && start.known.model->span().planar;
  std::optional<std::vector<Span::Contact>> contacts =
      moved_contacts(span, start.known.model->span().contacts);
  if (!contacts) return {};
  span.contacts = std::move(*contacts);
  SpanSolution solution = solve_near_known(span, options, workspace);
  // At a point that becomes a part the gap has no minimum, and the part is still too short to
  // resolve.
  if (!solution.is_equilibrium() && fix_contact_points(span)) {
    solution = active_set.newton_from(span, start.field);
  }
  if (!solution.is_equilibrium()) return solution;
  const Eigen::Matrix3Xd turned =
      solution.at_x()->tangents() - start.field(solution.model->nodes()).tangents;
  if (!(turned.cwiseAbs().maxCoeff() < largest_followed_change)) return {};
  solution = active_set.solve(std::move(solution));
  solution.followed = succeeded(solution.status) || solution.is_singular_point();
  return solution;
}

}  // namespace dlo::energy_model
