#pragma once

#include <vector>

#include "base/deadline.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// Result of a search for equilibria of a span.
struct SpanSearchResult {
  std::vector<SpanEquilibrium> found;  ///< stable ones first, by energy; never empty
  bool complete = true;                ///< false: the deadline ended the search early
};

/// Finds equilibria by Newton's method from the minima of polygons (relaxed_polygon.hpp), in the
/// span's plane and out of it: from the six lowest ones, and from ten more while none of the
/// results is stable. If a polygon's force is large for its mesh, or Newton's method does not
/// converge, the polygon is relaxed again on a finer mesh. An unstable equilibrium below all stable
/// ones is left in both directions along the mode of its smallest eigenvalue, and the polygon is
/// relaxed from there. If nothing is stable then, the gradient flow starts from the lowest
/// equilibrium. If nothing is found, a failed result is returned.
///
/// Frames after the first clamp are released for this search. If clamps hold frames, those of the
/// lowest equilibrium are then rotated to the held ones (span_twist.hpp); the result is then one
/// equilibrium, or a failed one.
[[nodiscard]] SpanSearchResult search_span(const RodSpan& span, double tolerance,
                                           const Deadline& deadline);

/// Returns the length of intervals that resolves the bends by a force over b and by the natural
/// strains.
[[nodiscard]] double resolving_interval(const RodSpan& span, double force);

/// Checks that weight and loads are not too large for the softest section.
/// @throws std::invalid_argument if they are
void check_load(const RodSpan& span);

}  // namespace dlo::energy_model
