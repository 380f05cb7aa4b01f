#pragma once

#include "span/local_solver.hpp"

namespace dlo::energy_model {

/// Solves for the lowest shape of a plain cantilever that is pulled in one direction; it is not
/// certified out of the plane. Newton's method is tried first. If it converges to another shape, a
/// descent follows from the soft limit.
[[nodiscard]] SpanSolution plain_cantilever(LocalSolver& on);

}  // namespace dlo::energy_model
