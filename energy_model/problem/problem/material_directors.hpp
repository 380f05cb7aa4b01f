#pragma once

#include "dlo/energy_model/problem.hpp"
#include "problem/ordered_grips.hpp"
#include "problem/split.hpp"

namespace dlo::energy_model {

/// Stiffnesses and natural strains of a rod with material directors, about the axes of the frame
/// that the span has at its start, in its units; `ahead`; and whether it still lies in its plane.
/// @param anchor  the grip that the span counts from
/// @param placed  with everything else in its frame
void place_material_directors(const Problem& problem, const OrderedGrip& anchor,
                              PlacedSpan& placed);

}  // namespace dlo::energy_model
