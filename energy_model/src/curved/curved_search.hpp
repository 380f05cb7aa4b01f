#pragma once

#include "base/deadline.hpp"
#include "curved/curved_rod.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "shooting/span_equilibrium.hpp"
#include "shooting/span_shooting.hpp"

namespace dlo::energy_model {

/// Equilibria that Newton's method finds from minima of polygons (curved_polygon.hpp), in the rod's
/// plane if it has one and out of it: from the eight lowest ones, from eight more while none of
/// what they led to is stable. What is unstable and lower than all that is stable is left both ways
/// along the mode of its smallest eigenvalue. If nothing is found, one that has failed.
///
/// Frames after the first clamp are let go for that. From the lowest equilibrium on they are then
/// turned to where they are held, by continuation; where a shape becomes unstable, or jumps, the
/// polygon is relaxed from it. One equilibrium then, or one that has failed and says how far it
/// came.
[[nodiscard]] SpanSearchResult search_curved(const CurvedRod& rod, double tolerance,
                                             const Deadline& deadline);

/// The equilibrium that Newton's method leads to from a shape of this problem or a similar one: its
/// frames are those of its d1, or turn from the first clamp's by the torque that its grips imply
/// where it has none.
/// @throws std::invalid_argument if there is no clamp
[[nodiscard]] SpanEquilibrium refine_curved(const CurvedRod& rod, const Problem& problem,
                                            const Equilibrium& shape, double tolerance,
                                            const Deadline& deadline);

}  // namespace dlo::energy_model
