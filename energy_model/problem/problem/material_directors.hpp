#pragma once

#include "dlo/energy_model/problem.hpp"
#include "problem/ordered_grips.hpp"
#include "problem/split.hpp"

namespace dlo::energy_model {

/// Places stiffnesses and natural strains of a rod with material directors in a span, about the
/// axes of the span's frame at its start, in the span's units. Sets `ahead`, and whether the span
/// is still planar.
/// @param anchor  grip from which the span is measured
/// @param placed  span whose other members are already in its frame
void place_material_directors(const Problem& problem, const OrderedGrip& anchor,
                              PlacedSpan& placed);

}  // namespace dlo::energy_model
