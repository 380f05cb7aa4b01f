#include "base/found_equilibria.hpp"

#include <tuple>
#include <utility>

namespace dlo::energy_model {

Combinations lowest_combinations(const std::vector<std::vector<SpanCandidate>>& candidates,
                                 std::size_t most) {
  struct Choice {
    std::size_t unstable = 0;
    double energy = 0;
    std::vector<std::size_t> own;
  };
  Combinations result;
  // The lowest combinations of the spans so far. Others are no part of a lowest combination.
  std::vector<Choice> lowest(most > 0 ? 1 : 0);
  for (const std::vector<SpanCandidate>& own : candidates) {
    std::vector<Choice> longer;
    for (const Choice& before : lowest) {
      for (std::size_t i = 0; i < own.size(); ++i) {
        Choice& choice = longer.emplace_back(before);
        choice.unstable += own[i].stable ? 0 : 1;
        choice.energy +=
            std::isnan(own[i].energy) ? std::numeric_limits<double>::infinity() : own[i].energy;
        choice.own.push_back(i);
      }
    }
    std::ranges::stable_sort(longer, [](const Choice& a, const Choice& b) {
      return std::tie(a.unstable, a.energy) < std::tie(b.unstable, b.energy);
    });
    result.truncated = !longer.empty() && (result.truncated || longer.size() > most);
    longer.resize(std::min(longer.size(), most));
    lowest = std::move(longer);
  }
  for (Choice& choice : lowest) result.choices.push_back(std::move(choice.own));
  return result;
}

}  // namespace dlo::energy_model
