#pragma once

#include <vector>

#include "problem/span.hpp"

namespace dlo::energy_model {

/// Returns copies of the span with pins next to its obstacles, so that shapes through the pins pass
/// an obstacle on either side: first single obstacles, nearest to the anchor first, then pairs; at
/// most ten copies. Between two grips such a shape continues to the second grip; beyond the
/// outermost grip the rod hangs from the obstacle. There is no copy for half-spaces, for obstacles
/// that the rod is too short to pass, and for paths through a rigid obstacle.
[[nodiscard]] std::vector<Span> pinned_past_obstacles(const Span& span);

}  // namespace dlo::energy_model
