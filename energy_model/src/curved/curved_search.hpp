#pragma once

#include <vector>

#include "base/deadline.hpp"
#include "curved/curved_shooting.hpp"
#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::energy_model {

/// What a search has found, and whether it came to its end.
struct CurvedSearchResult {
  std::vector<CurvedEquilibrium> found;  ///< stable ones first, by energy; never empty
  bool complete = true;                  ///< false: the deadline has cut it short
};

/// Equilibria that Newton's method finds from minima of polygons (curved_polygon.hpp), in the rod's
/// plane if it has one and out of it: from the eight lowest ones, from eight more while none of
/// what they led to is stable. What is unstable and lower than all that is stable is left both ways
/// along the mode of its smallest eigenvalue. If nothing is found, one that has failed.
///
/// Frames after the first clamp are let go for that. From the lowest equilibrium on they are then
/// turned to where they are held, by continuation; where a shape becomes unstable, or jumps, the
/// polygon is relaxed from it. One equilibrium then, or one that has failed and says how far it
/// came.
[[nodiscard]] CurvedSearchResult search_curved(const CurvedRod& rod, double tolerance,
                                               const Deadline& deadline);

/// The equilibrium that Newton's method leads to from a shape of this problem or a similar one: its
/// frames are those of its d1, or turn from the first clamp's by the torque that its grips imply
/// where it has none.
/// @throws std::invalid_argument if there is no clamp
[[nodiscard]] CurvedEquilibrium refine_curved(const CurvedRod& rod, const Problem& problem,
                                              const Equilibrium& shape, double tolerance,
                                              const Deadline& deadline);

}  // namespace dlo::energy_model
