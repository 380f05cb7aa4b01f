#pragma once

#include <Eigen/Core>
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

/// A shape along points, to start from: its tangents are those of chords between points that are no
/// closer than a sixty-fourth of the rod, so that scatter across the rod tilts them little; beyond
/// the first and the last point it is straight.
/// @param arc_lengths  of the points [m], growing, two or more;  @param points  [m], 3 x M
/// @param length  of the rod [m]
/// @throws std::invalid_argument if these are out of range, or if two points that follow each other
/// coincide
[[nodiscard]] Equilibrium shape_through(const std::vector<double>& arc_lengths,
                                        const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                        double length);

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
