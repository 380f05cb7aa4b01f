#pragma once

#include "span/local_solver.hpp"

namespace dlo::energy_model {

/// The lowest shape of a plain cantilever that is pulled one way, not certified out of the plane:
/// by Newton's method at once; where that leads elsewhere, downhill from the straight rod for a
/// stiff one, from the soft limit for a soft one or where straight is a saddle.
[[nodiscard]] SpanSolution plain_cantilever(LocalSolver& on);

}  // namespace dlo::energy_model
