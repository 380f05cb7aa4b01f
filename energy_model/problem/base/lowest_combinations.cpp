#include "base/lowest_combinations.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

namespace dlo::energy_model {
namespace {

double energy_or_infinite(const SpanCandidate& candidate) {
  return std::isnan(candidate.energy) ? std::numeric_limits<double>::infinity() : candidate.energy;
}

/// Returns the indices of the candidates: stable ones first, by energy.
std::vector<std::size_t> by_cost(const std::vector<SpanCandidate>& candidates) {
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(!candidates[a].stable, energy_or_infinite(candidates[a])) <
           std::pair(!candidates[b].stable, energy_or_infinite(candidates[b]));
  });
  return order;
}

struct PartialChoice {
  std::size_t unstable = 0;
  double energy = 0;
  std::size_t moved = 0;  // last span that is not at its first candidate, or the first span
  std::vector<std::size_t> ranks;

  /// Whether this choice comes first: fewest unstable candidates, then lowest energy, then lowest
  /// ranks.
  bool operator<(const PartialChoice& other) const {
    return std::tie(unstable, energy, ranks) < std::tie(other.unstable, other.energy, other.ranks);
  }
};

}  // namespace

Combinations lowest_combinations(const std::vector<std::vector<SpanCandidate>>& candidates,
                                 std::size_t most) {
  Combinations result;
  std::vector<std::vector<std::size_t>> orders;
  for (const std::vector<SpanCandidate>& own : candidates) {
    if (own.empty()) return result;
    orders.push_back(by_cost(own));
  }
  const auto priced = [&](std::vector<std::size_t> ranks, std::size_t moved) {
    // The energy is summed anew each time, because differences of large energies would accumulate
    // rounding.
    PartialChoice choice;
    choice.moved = moved;
    for (std::size_t i = 0; i < ranks.size(); ++i) {
      const SpanCandidate& own = candidates[i][orders[i][ranks[i]]];
      choice.unstable += own.stable ? 0 : 1;
      choice.energy += energy_or_infinite(own);
    }
    choice.ranks = std::move(ranks);
    return choice;
  };
  std::set<PartialChoice> queue;  // no longer than the number of choices that may still be returned
  if (most > 0) queue.insert(priced(std::vector<std::size_t>(candidates.size(), 0), 0));
  while (!queue.empty()) {
    const PartialChoice best = std::move(queue.extract(queue.begin()).value());
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < orders.size(); ++i) chosen.push_back(orders[i][best.ranks[i]]);
    result.choices.push_back(std::move(chosen));
    // Only spans from the last advanced one on are advanced, so that each combination is reached
    // once.
    for (std::size_t i = best.moved; i < orders.size(); ++i) {
      if (best.ranks[i] + 1 == orders[i].size()) continue;
      std::vector<std::size_t> next = best.ranks;
      ++next[i];
      queue.insert(priced(std::move(next), i));
      if (queue.size() + result.choices.size() <= most) continue;
      queue.erase(std::prev(queue.end()));
      result.truncated = true;
    }
  }
  return result;
}

}  // namespace dlo::energy_model
