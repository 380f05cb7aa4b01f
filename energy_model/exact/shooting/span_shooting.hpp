#pragma once

#include <vector>

#include "base/deadline.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// What a search has found, and whether it came to its end.
struct SpanSearchResult {
  std::vector<SpanEquilibrium> found;  ///< stable ones first, by energy; never empty
  bool complete = true;                ///< false: the deadline has cut it short
};

/// Equilibria that Newton's method finds from the minima of polygons (relaxed_polygon.hpp), in the
/// span's plane and out of it: from the six lowest ones, from ten more while none of what they led
/// to is stable. Where a polygon's force is large for its mesh, or Newton's method does not
/// converge, it is relaxed again on a finer one. What is unstable and lower than all that is stable
/// is left both ways along the mode of its smallest eigenvalue, and the polygon is relaxed from
/// there; if nothing is stable then, the gradient flow leads on from the lowest one. If nothing is
/// found, one that has failed.
///
/// Frames after the first clamp are released for that. From the lowest equilibrium on they are then
/// turned to where they are held (span_twist.hpp): one equilibrium then, or one that has failed.
[[nodiscard]] SpanSearchResult search_span(const RodSpan& span, double tolerance,
                                           const Deadline& deadline);

/// Intervals that resolve what a force over b and the natural strains bend.
[[nodiscard]] double resolving_interval(const RodSpan& span, double force);

/// @throws std::invalid_argument if weight and loads are too large for the softest section
void check_load(const RodSpan& span);

}  // namespace dlo::energy_model
