#pragma once

#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "problem/split.hpp"
#include "span/span_solver.hpp"

namespace dlo::energy_model {

/// An equilibrium of a span, and the frame that it is found in.
struct PlacedSolution {
  PlacedSpan placed;
  SpanSolution solution;
};

/// Tangents of an equilibrium as a span sees them; both have to outlive it.
[[nodiscard]] TangentField field_of(const Equilibrium& start, const PlacedSpan& placed,
                                    double length);

/// What an equilibrium says of the twist of a span; null: nothing.
[[nodiscard]] const TwistedPart* known_twist(const Equilibrium& known, const PlacedSpan& placed,
                                             double length);

/// What touches a span in an equilibrium, by growing s; obstacles have their index alone.
[[nodiscard]] std::vector<Span::Contact> known_contacts(const Equilibrium& known,
                                                        const PlacedSpan& placed, double length);

/// The spans of a problem at a known equilibrium, all as ones in space that bend out of their plane
/// too, each by Newton's method from its shape.
/// @param terms  of each piece
[[nodiscard]] std::vector<PlacedSolution> spans_in_space(const Problem& problem,
                                                         const Equilibrium& known, int terms,
                                                         const Deadline& deadline,
                                                         SpanWorkspace& workspace);

}  // namespace dlo::energy_model
