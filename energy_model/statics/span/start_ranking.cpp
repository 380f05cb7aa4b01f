#include "span/start_ranking.hpp"

#include <algorithm>
#include <limits>

#include "newton/restore.hpp"

namespace dlo::energy_model {
namespace {

/// Maximum number of Newton steps of a fit if the constraints are restored afterwards.
constexpr int no_corrections = 0;

bool is_cheaper(const Start& a, const Start& b) { return a.cost < b.cost; }

void rank_with_springs(SpanSolution& looked, const StartRanking& ranking,
                       std::vector<Start>& starts) {
  SpanPoint point;
  for (Start& start : starts) {
    looked.evaluate(looked.model->fit(start.field(looked.model->nodes())), point);
    if (ranking.keeps_unknowns) {
      start.model = looked.model;
      start.x = point.x;
    }
    start.cost = point.energy + ranking.stiffness / 2 * point.residual.squaredNorm();
  }
}

/// Ranks starts by their energy once the constraints are satisfied, for those starts that may still
/// be among the ones followed in any case. With a remaining constraint residual a shape would seem
/// cheaper than any that satisfies the constraints.
void rank_with_constraints(SpanSolution& looked, const StartRanking& ranking,
                           std::vector<Start>& starts) {
  // Springs at the grips, as at the begin of a penalty method: a lower bound of the cost of the
  // residual.
  const double kappa = 100 * (1 + ranking.load);
  SpanEnergy& model = *looked.model;
  for (Start& start : starts) {
    start.shape = start.field(model.nodes());
    const SpanEnergy::Estimate seen = model.estimate(start.shape.tangents);
    start.cost = seen.energy + kappa / 2 * seen.gap * seen.gap;
    // A fit with few coefficients is smoother, and satisfying the constraints may straighten it.
    start.least = seen.energy - seen.bending / 2;
  }
  std::stable_sort(starts.begin(), starts.end(), is_cheaper);
  std::vector<double> energies;  // lowest energies of starts that satisfy the constraints
  SpanPoint point;
  RestoreScratch scratch;
  for (Start& start : starts) {
    if (ranking.deadline != nullptr && ranking.deadline->passed()) return;
    const double most = energies.size() < ranking.followed ? std::numeric_limits<double>::infinity()
                                                           : energies.back();
    if (start.least > most) continue;
    looked.evaluate(model.fit(start.shape, no_corrections), point);
    if (!restore(looked, point, loosest_gap, scratch, most)) {
      start.cost = std::max(start.cost, most);
      continue;
    }
    start.model = looked.model;
    start.x = point.x;
    start.cost = point.energy;
    energies.insert(std::upper_bound(energies.begin(), energies.end(), point.energy), point.energy);
    if (energies.size() > ranking.followed) energies.pop_back();
  }
}

}  // namespace

int rank_starts(std::vector<Start>& starts, const StartRanking& ranking) {
  SpanSolution looked;
  looked.model = ranking.model;
  if (ranking.satisfies_constraints) {
    rank_with_constraints(looked, ranking, starts);
  } else {
    rank_with_springs(looked, ranking, starts);
  }
  std::stable_sort(starts.begin(), starts.end(), is_cheaper);
  return looked.evaluations;
}

}  // namespace dlo::energy_model
