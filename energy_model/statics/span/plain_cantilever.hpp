#pragma once

#include "span/local_solver.hpp"

namespace dlo::energy_model {

/// Solves for the lowest shape of a plain cantilever that is pulled in one direction; it is not
/// certified out of the plane. Newton's method is tried first. If it converges to another shape, a
/// descent follows: from the straight rod for a stiff one, from the soft limit for a soft one or if
/// the straight rod leads to a saddle.
[[nodiscard]] SpanSolution plain_cantilever(LocalSolver& on);

}  // namespace dlo::energy_model
