#pragma once

#include <vector>

#include "problem/span.hpp"

namespace dlo::energy_model {

/// Returns the span with pins beside its obstacles, so that the shapes that meet the pins pass an
/// obstacle on either side: one obstacle at a time, those nearest to the anchor first, then two in
/// a row, at most ten spans. Between two grips such a rod goes on to the second grip; beyond the
/// outermost grip it hangs from the obstacle. Half-spaces, obstacles that the rod is too short to
/// pass, and ways through a rigid obstacle have no such span.
[[nodiscard]] std::vector<Span> held_past_obstacles(const Span& span);

}  // namespace dlo::energy_model
