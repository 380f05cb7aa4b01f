#pragma once

#include <vector>

#include "base/deadline.hpp"
#include "dlo/energy_model/problem.hpp"
#include "problem/split.hpp"
#include "search/span_solver.hpp"

namespace dlo::energy_model {

/// Tangents of the lowest minima of a coarse polygon, lowest first, in the span's frame: those that
/// solve_exact() shoots from. For a planar span those in its plane and those out of it.
[[nodiscard]] std::vector<TangentField> polygon_fields(const Problem& problem,
                                                       const PlacedSpan& placed,
                                                       const Deadline& deadline);

}  // namespace dlo::energy_model
