#pragma once

#include <optional>
#include <vector>

#include "frames/span_shape.hpp"
#include "problem/span.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// What a shape may be behind a rigid obstacle and still be on it, in lengths: rounding.
inline constexpr double deepest = 1e-9;
/// The same while terms may be missing.
inline constexpr double deepest_coarse = 1e-6;

/// Whether a shape has all the terms that it takes; before, the pressure on what lies says nothing.
enum class Resolution {
  coarse,
  resolved,
};

/// Looks whether contacts are those of an equilibrium: no obstacle pulls (concentrated forces and
/// pressures are above -1e-7 of all forces) and nothing is more than `deepest` (`deepest_coarse`)
/// lengths behind one.
/// @return nothing if so; else the contacts to try next: without those that pull, points where they
///         lie too short, at both ends of a part along which the rod is pulled at, one where two
///         meet, more where the rod is behind an obstacle
[[nodiscard]] std::optional<std::vector<Span::Contact>> updated_contacts(
    const SpanSolution& solution, double load, Resolution resolution);

/// Whether a contact and the next one are one: with the same obstacle, and the rod hardly leaves it
/// between them or is behind it.
[[nodiscard]] bool are_one(const Span::Contact& here, const Span::Contact& next, const Span& span,
                           const SpanShape& shape);

}  // namespace dlo::energy_model
