#pragma once

#include "figure/layout.hpp"
#include "study/stability_map.hpp"

namespace dlo::compare {

/// The grid of a map, each point by what became of the rod, and its limits.
[[nodiscard]] Figure map_figure(const StabilityMap& map);

}  // namespace dlo::compare
