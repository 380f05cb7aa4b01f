#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "problem/split.hpp"
#include "span/span_solver.hpp"

namespace dlo::energy_model {

/// An equilibrium of a span, and the frame in which it was found.
struct PlacedSolution {
  PlacedSpan placed;
  SpanSolution solution;
};

/// Returns a shape along points as an initial guess; only its tangents are set. They are
/// interpolated between those of chords between points at least a sixty-fourth of the rod apart
/// (except for the last chord), so that scatter across the rod tilts them little. Beyond the middle
/// of the first and the last chord the shape is straight.
/// @param arc_lengths  of the points [m], ascending, two or more;  @param points  [m], 3 x M
/// @param length  of the rod [m]
/// @throws std::invalid_argument if a value is out of range, not ascending or not finite, if there
///   are fewer than two points or another number of arc lengths, or if all points coincide
[[nodiscard]] Equilibrium shape_through(const std::vector<double>& arc_lengths,
                                        const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                        double length);

/// Returns the tangents of an equilibrium in a span's frame, and the roll of a rod with material
/// directors. `start` and `placed` have to outlive the result.
[[nodiscard]] TangentField field_of(const Equilibrium& start, const PlacedSpan& placed,
                                    double length);

/// Returns an equilibrium's twist of a span; null if it has none.
[[nodiscard]] const TwistedPart* known_twist(const Equilibrium& known, const PlacedSpan& placed,
                                             double length);

/// Returns the contacts of a span in an equilibrium, by ascending s; of each obstacle only the
/// index is set.
[[nodiscard]] std::vector<Span::Contact> known_contacts(const Equilibrium& known,
                                                        const PlacedSpan& placed, double length);

/// Returns the spans of a problem at a known equilibrium, all in space, so that they bend out of
/// their plane too, and without rigid obstacles. Each is solved again from its shape.
/// @param terms  number of coefficients of each element
/// @throws std::invalid_argument as split(), or if a span has more unknowns than affordable
[[nodiscard]] std::vector<PlacedSolution> spans_in_space(const Problem& problem,
                                                         const Equilibrium& known, int terms,
                                                         const Deadline& deadline,
                                                         SpanWorkspace& workspace);

}  // namespace dlo::energy_model
