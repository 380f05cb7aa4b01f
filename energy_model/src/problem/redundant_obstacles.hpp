#pragma once

#include "problem/span.hpp"

namespace dlo::energy_model {

/// Takes away the rigid obstacles that lie, as far as the rod reaches, within another one. A
/// contact with both would be one condition twice, whose multipliers are not determined. Of two
/// that coincide the first stays. What is left keeps the rod out of all of them, but for rounding.
void remove_redundant_obstacles(Span& span);

}  // namespace dlo::energy_model
