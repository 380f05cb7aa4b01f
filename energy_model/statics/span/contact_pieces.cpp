#include "span/contact_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "certify/contact_ends.hpp"

namespace dlo::energy_model {
namespace {

constexpr int most_contact_rounds = 16;

/// Largest number of coefficients in rounds before the ends are nearly accurate; each element is
/// short.
constexpr int first_round_terms = 16;

/// Movement of the ends, divided by the rod length, below which coefficients are added, and below
/// which the iteration ends.
constexpr double ends_nearly_settled = 1e-4;
constexpr double ends_settled = 1e-9;

/// Returns the largest movement of an end; infinity if the number of ends has changed.
double moved_by(const std::vector<double>& before, const std::vector<double>& now) {
  if (before.size() != now.size()) return std::numeric_limits<double>::infinity();
  double moved = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    moved = std::max(moved, std::abs(now[i] - before[i]));
  }
  return moved;
}

}  // namespace

SpanSolution on_other_pieces(LocalSolver& on, const SpanSolution& solution, int terms) {
  SpanSolution other = on.empty_solution(terms);
  const TangentField field = solution.model->field(solution.x);
  other.x = other.model->fit(field(other.model->nodes()));
  if (other.model->constraints() == solution.multipliers.size()) {
    other.multipliers = solution.multipliers;
  }
  other.evaluations = solution.evaluations;
  return other;
}

SpanSolution with_found_pieces(
    LocalSolver& on, SpanSolution solution,
    const std::function<SpanSolution(LocalSolver&, SpanSolution)>& refine) {
  Span span = on.span();
  std::vector<double> ends = contact_ends(solution);
  bool refined = false;
  for (int round = 0; round < most_contact_rounds && solution.is_equilibrium(); ++round) {
    if (on.out_of_time()) {
      solution.finish(SolveStatus::time_limit);
      return solution;
    }
    const bool same_pieces = ends == span.contact_ends;
    span.contact_ends = ends;
    LocalSolver own(span, on.options(), on.workspace());
    if (!same_pieces) {
      const int terms = refined ? solution.terms : std::min(solution.terms, first_round_terms);
      solution = on_other_pieces(own, solution, on.options().terms > 0 ? solution.terms : terms);
      own.newton(solution);
      if (!solution.is_equilibrium()) own.descend(solution);
    }
    if (refined || same_pieces) solution = refine(own, std::move(solution));
    if (!solution.is_equilibrium()) return solution;
    std::vector<double> now = contact_ends(solution);
    const double moved = moved_by(ends, now);
    if ((refined || same_pieces) && moved <= ends_settled) return solution;
    refined = refined || moved <= ends_nearly_settled;
    ends = std::move(now);
  }
  if (solution.is_equilibrium()) {
    solution.resolved = false;
    solution.fail("the ends of contact with soft obstacles were not found");
  }
  return solution;
}

}  // namespace dlo::energy_model
