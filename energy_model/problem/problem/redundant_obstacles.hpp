#pragma once

#include <cstddef>

#include "problem/span.hpp"

namespace dlo::energy_model {

/// Removes the rigid obstacles that lie, as far as the rod reaches, within another one. Contact
/// with both would be the same constraint twice, with undetermined multipliers. Of two that
/// coincide the first stays. The remaining obstacles keep the rod out of all of them, up to
/// rounding.
void remove_redundant_obstacles(Span& span);

/// Removes rigid obstacles whose surface differs little from that of an obstacle that stays.
/// Contact with both would be nearly the same constraint twice, and the active set would alternate
/// between them. The caller has to verify that the rod stays out of the removed obstacles.
/// @param preferred  index in the problem of the obstacle that stays in any case
/// @return whether an obstacle was removed
bool omit_similar_obstacles(Span& span, std::size_t preferred);

}  // namespace dlo::energy_model
