#include "search/follow_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "certify/enough_terms.hpp"
#include "search/active_set.hpp"

namespace dlo::energy_model {
namespace {

/// Whether the last two shapes have the same unknowns and contacts, so that they can be
/// extrapolated.
bool goes_on_like_before(const SpanStart& start) {
  const KnownShape& known = start.known;
  const KnownShape& before = start.before;
  if (!before.model || before.x.size() != known.x.size() ||
      before.model->terms() != known.model->terms() ||
      before.multipliers.size() != known.multipliers.size()) {
    return false;
  }
  const std::vector<Span::Contact>& a = before.model->span().contacts;
  const std::vector<Span::Contact>& b = known.model->span().contacts;
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    return x.obstacle.index == y.obstacle.index && x.lies() == y.lies();
  });
}

/// Returns a number of coefficients that suffices for the known shape, which may have more than
/// needed: a contact that has just begun needs many for a while. For rods in the plane.
int enough_terms_of_known(const SpanOptions& options, const ActiveSet& active_set) {
  // The criterion of refined(), with a margin.
  constexpr double margin = 0.1;
  const SpanEnergy& model = *options.start.known.model;
  const int many = model.terms();
  if (!model.span().planar || options.terms > 0) return many;
  const int least = std::max(active_set.terms_of_load(model.span()), many - std::max(2, many / 5));
  return terms_needed(model, options.start.known.x, margin * options.tolerance, least);
}

/// Solves for the equilibrium with the known contacts, by Newton's method from the extrapolation of
/// the last two shapes.
/// @param share  step of the extrapolation, divided by the last change; 0: start at the known shape
SpanSolution next_to_known(Span span, double share, const SpanOptions& options,
                           SpanWorkspace& workspace, const ActiveSet& active_set) {
  const KnownShape& known = options.start.known;
  const KnownShape& before = options.start.before;
  for (std::size_t i = 0; share > 0 && i < span.contacts.size(); ++i) {
    const Span::Contact& last = before.model->span().contacts[i];
    const Span::Contact at = span.contacts[i];
    // Contacts at the ends of the rod do not move along it.
    const bool inside = at.begin > 0 && at.end < span.length;
    const double begin = at.begin + share * (at.begin - last.begin);
    const double end = at.end + share * (at.end - last.end);
    const bool ordered = (i == 0 || begin > span.contacts[i - 1].end) && begin <= end &&
                         begin > 0 && end < span.length;
    if (!inside || !ordered) continue;
    span.contacts[i].begin = begin;
    span.contacts[i].end = at.lies() ? end : begin;
  }
  SpanSolution solution = workspace.empty_solution(
      span, share > 0 ? enough_terms_of_known(options, active_set) : known.model->terms());
  SpanEnergy& model = *solution.model;
  if (model.pieces() != known.model->pieces()) return {};
  const bool fits = span.planar || span.has_material_directors();
  // The fit also determines the winding of the clamps.
  solution.x =
      fits ? model.fit(options.start.field(model.nodes())) : model.prolong(*known.model, known.x);
  // A part that becomes short has fewer multipliers.
  const bool as_held = known.multipliers.size() == model.constraints();
  if (as_held) solution.multipliers = known.multipliers;
  const bool as_many = solution.terms == known.model->terms();
  if (share > 0 && as_many && as_held && known.x.size() == solution.x.size()) {
    solution.x = known.x + share * (known.x - before.x);
    solution.multipliers += share * (known.multipliers - before.multipliers);
  }
  newton_solve(solution, {.load = span.total_load(), .deadline = &options.deadline},
               workspace.newton());
  return solution;
}

}  // namespace

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
  const double share = goes_on_like_before(start) ? 1 : 0;
  SpanSolution solution = next_to_known(span, share, options, workspace, active_set);
  if (share > 0 && !solution.is_equilibrium()) {
    solution = next_to_known(span, 0, options, workspace, active_set);
  }
  // At a point that becomes a part the gap has no minimum, and the part is still too short to
  // resolve.
  if (!solution.is_equilibrium() && hold_points(span)) {
    solution = active_set.newton_from(span, start.field);
  }
  if (!solution.is_equilibrium()) return solution;
  const Eigen::Matrix3Xd turned =
      solution.at_x()->tangents() - start.field(solution.model->nodes()).tangents;
  if (!(turned.cwiseAbs().maxCoeff() < followed_tangents)) return {};
  solution = active_set.solve(std::move(solution));
  solution.followed = succeeded(solution.status) || solution.is_singular_point();
  return solution;
}

}  // namespace dlo::energy_model
