#pragma once

#include <cstddef>
#include <vector>

namespace dlo::energy_model {

/// Stability and energy of one equilibrium of a span, by which combinations are ordered.
struct SpanCandidate {
  bool stable = false;
  double energy = 0;  ///< NaN counts as infinity
};

/// Combinations of one candidate of each span (lowest_combinations()).
struct Combinations {
  std::vector<std::vector<std::size_t>> choices;  ///< one candidate index per span in each choice
  bool truncated = false;                         ///< whether there are more than were requested
};

/// Returns the first `most` combinations in this order: fewest unstable candidates first, then
/// lowest sum of energies; equal candidates keep their order. The search is best-first, so that
/// neither time nor memory grows with the product of the numbers of candidates.
/// @param candidates  candidates of each span, in any order. There is no combination if one span
///                    has none
[[nodiscard]] Combinations lowest_combinations(
    const std::vector<std::vector<SpanCandidate>>& candidates, std::size_t most);

}  // namespace dlo::energy_model
