#pragma once

#include "suite/cause.hpp"

namespace dlo::compare {

/// The bending stiffness that fits a shape with so many points best.
struct StiffnessFactor {
  int points = 0;     ///< N
  double factor = 0;  ///< over the scene's [-], > 0
};

/// What a stiffness is that depends on the number of points, or does not: a power of the element's
/// length, or a weight to which each element's ends add, as those of capsules do.
/// @param coarse, fine  of the smallest and the largest N
[[nodiscard]] Cause cause_of_factors(const Scene& scene, const StiffnessFactor& coarse,
                                     const StiffnessFactor& fine);

}  // namespace dlo::compare
