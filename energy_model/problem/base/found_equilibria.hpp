#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
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

/// Returns the lowest unstable shape whose energy is below that of all stable ones, which shows
/// that a minimum has been missed; null if there is none.
/// @param left  energies of the shapes to exclude: the saddles that have already been left
template <typename Shape>
[[nodiscard]] const Shape* missed_minimum(const std::vector<Shape>& found,
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
  std::stable_sort(found.begin(), found.end(), [](const Shape& a, const Shape& b) {
    if (a.stable() != b.stable()) return a.stable();
    const double rounding = 1e-11 * (1 + std::abs(a.energy.total()));
    return a.energy.total() < b.energy.total() - rounding;
  });
}

}  // namespace dlo::energy_model
