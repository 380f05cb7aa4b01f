#pragma once

#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"
#include "problem/split.hpp"
#include "search/remembered.hpp"
#include "span/span_options.hpp"
#include "span/span_workspace.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Solves a span of a problem without the twist from clamps: from a known shape, if there is one;
/// otherwise by a search, and from minima of coarse polygons if the search finds no stable shape,
/// or all are wanted. The list is never empty, best first.
/// @param shape, last  initial guesses, each may be null; `shape` is used if both are given
[[nodiscard]] std::vector<SpanSolution> solve_untwisted(const PlacedSpan& placed,
                                                        const Problem& problem, SpanOptions options,
                                                        const Equilibrium* shape,
                                                        const Remembered* last,
                                                        SpanWorkspace& workspace);

}  // namespace dlo::energy_model
