#pragma once

#include "dlo/compare/solution.hpp"
#include "polygon/natural_plane.hpp"

namespace dlo::compare {

/// A polygon's solution of the scene that `turn` has laid into its plane, as it is in space.
[[nodiscard]] Solution turned_back(Solution solution, const PlaneTurn& turn);

}  // namespace dlo::compare
