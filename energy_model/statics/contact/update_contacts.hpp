#pragma once

#include <optional>
#include <vector>

#include "frames/span_shape.hpp"
#include "problem/span.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Largest depth within a rigid obstacle of a shape that counts as on it, divided by the rod
/// length: rounding.
inline constexpr double deepest = 1e-9;
/// Largest depth, likewise, while coefficients may be missing.
inline constexpr double deepest_coarse = 1e-6;

/// Whether a shape has all coefficients that it needs; before that the pressure on a part is not
/// meaningful.
enum class Resolution {
  coarse,
  resolved,
};

/// Checks whether the contacts are those of an equilibrium: no obstacle pulls (concentrated forces
/// and pressures are above -1e-7 of all forces), and no point is deeper than `deepest`
/// (`deepest_coarse`) rod lengths within one.
/// @return std::nullopt if so; otherwise the contacts to try next: points that pull are released,
///   parts that pull at an end or are too short become a point, parts that pull between their ends
///   become two points, contacts that meet are joined, and contacts are added where the rod is
///   within an obstacle
[[nodiscard]] std::optional<std::vector<Span::Contact>> updated_contacts(
    const SpanSolution& solution, double load, Resolution resolution);

}  // namespace dlo::energy_model
