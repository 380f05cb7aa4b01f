#pragma once

#include <vector>

#include "base/deadline.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// What a search has found, and whether it came to its end.
struct SpanSearchResult {
  std::vector<SpanEquilibrium> found;  ///< stable ones first, by energy; never empty
  bool complete = true;                ///< false: the deadline has cut it short
};

/// Equilibria that Newton's method finds from the minima of polygons (relaxed_polygon.hpp), in the
/// span's plane and out of it: from the six lowest ones, from six more while none of what they led
/// to is stable. Where a polygon's force is large for its mesh, or Newton's method does not
/// converge, it is relaxed again on a finer one. What is unstable and lower than all that is stable
/// is left both ways along the mode of its smallest eigenvalue, and the polygon is relaxed from
/// there. If nothing is found, one that has failed.
[[nodiscard]] SpanSearchResult search_span(const RodSpan& span, double tolerance,
                                           const Deadline& deadline);

/// The lowest equilibrium without twist, and from there on the one with it (span_twist.hpp): one,
/// or one that has failed.
[[nodiscard]] SpanSearchResult search_twisted_span(const RodSpan& span, double tolerance,
                                                   const Deadline& deadline);

/// The equilibrium that Newton's method leads to from a shape of the problem that the span is of. A
/// shape that says nothing of the span's twist is refined without it and then twisted.
[[nodiscard]] SpanEquilibrium refine_span(const RodSpan& span, const Problem& problem,
                                          const Equilibrium& shape, double tolerance,
                                          const Deadline& deadline);

/// Force of what lies beyond the arc length s (over l) on what lies before, just after it, that the
/// grips' forces of a shape imply, in EI/l^2.
[[nodiscard]] Eigen::Vector3d implied_force(const Problem& problem, const Equilibrium& shape,
                                            double s);

}  // namespace dlo::energy_model
