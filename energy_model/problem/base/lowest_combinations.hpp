#pragma once

#include <cstddef>
#include <vector>

namespace dlo::energy_model {

/// What a choice among the equilibria of a span costs.
struct SpanCandidate {
  bool stable = false;
  double energy = 0;  ///< NaN counts as infinite
};

/// Combinations of one candidate of each span, see lowest_combinations().
struct Combinations {
  std::vector<std::vector<std::size_t>> choices;  ///< one index per span in each
  bool truncated = false;                         ///< there are more than were asked for
};

/// The `most` combinations that come first, in order: fewest unstable candidates first, lowest sum
/// of energies first among those; candidates that are equal keep their order. Best-first, so that
/// neither time nor memory grows with the product of the spans' candidates.
/// @param candidates  of each span, in any order; no combination if one span has none
[[nodiscard]] Combinations lowest_combinations(
    const std::vector<std::vector<SpanCandidate>>& candidates, std::size_t most);

}  // namespace dlo::energy_model
