#pragma once

#include <cstddef>

#include "problem/span.hpp"

namespace dlo::energy_model {

/// Takes away the rigid obstacles that lie, as far as the rod reaches, within another one. A
/// contact with both would be one condition twice, whose multipliers are not determined. Of two
/// that coincide the first stays. What is left keeps the rod out of all of them, but for rounding.
void remove_redundant_obstacles(Span& span);

/// Removes rigid obstacles whose surface differs little from that of an obstacle that stays. A
/// contact with both would be nearly one condition twice, and the active set would alternate
/// between them. The caller has to verify that the rod stays out of the obstacles that are omitted.
/// @param preferred  index in the problem of the obstacle that stays in any case
/// @return whether an obstacle was omitted
bool omit_similar_obstacles(Span& span, std::size_t preferred);

}  // namespace dlo::energy_model
