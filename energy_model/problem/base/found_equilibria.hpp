#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace dlo::energy_model {

/// Returns the lowest energy of the stable shapes that a search by shooting has found
/// (SpanEquilibrium); infinity if none is stable.
template <typename Shape>
[[nodiscard]] double lowest_stable_energy(const std::vector<Shape>& found) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Shape& shape : found) {
    if (shape.stable()) lowest = std::min(lowest, shape.energy.total());
  }
  return lowest;
}

/// Returns the lowest unstable shape, if its energy is not above that of the lowest stable one: a
/// minimum has been missed then. Else returns null.
/// @param left  energies of the shapes to exclude: the saddles that have already been left
template <typename Shape>
[[nodiscard]] const Shape* saddle_below_minima(const std::vector<Shape>& found,
                                               const std::vector<double>& left) {
  const double bound = lowest_stable_energy(found);
  const Shape* lowest = nullptr;
  for (const Shape& shape : found) {
    const double energy = shape.energy.total();
    const bool known = std::find(left.begin(), left.end(), energy) != left.end();
    if (shape.stable() || known || energy > bound) continue;
    if (lowest == nullptr || energy < lowest->energy.total()) lowest = &shape;
  }
  return lowest;
}

/// Sorts stable shapes first, by energy. Mirror images have equal energies up to rounding and keep
/// their order.
template <typename Shape>
void sort_by_stability(std::vector<Shape>& found) {
  std::ranges::stable_sort(found, [](const Shape& a, const Shape& b) {
    if (a.stable() != b.stable()) return a.stable();
    const double rounding = 1e-11 * (1 + std::abs(a.energy.total()));
    return a.energy.total() < b.energy.total() - rounding;
  });
}

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
/// lowest sum of energies; equal candidates keep their order. Spans are added one by one, and only
/// the first `most` combinations are kept, so that neither time nor memory grows with the product
/// of the numbers of candidates.
/// @param candidates  candidates of each span, in any order. There is no combination if one span
///                    has none
[[nodiscard]] Combinations lowest_combinations(
    const std::vector<std::vector<SpanCandidate>>& candidates, std::size_t most);

/// Returns the end of a message about a shape with this number of zero modes; empty if there is
/// none.
[[nodiscard]] inline std::string zero_modes_note(int ways) {
  if (ways == 0) return {};
  return ", " + std::to_string(ways) + (ways == 1 ? " zero mode" : " zero modes");
}

/// End of a message about a shape that couples bend.
inline constexpr const char* planar_check_note =
    "; checked in the plane alone, because a couple has no potential out of it";

}  // namespace dlo::energy_model
