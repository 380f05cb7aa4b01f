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

/// A span of a problem without the twist that clamps put into it: followed from a shape that is
/// known, where there is one; else searched, and from minima of coarse polygons where that leads to
/// no stable shape, or all are wanted. Never empty, best first.
/// @param shape, last to start from, the first of them that is there, or neither
[[nodiscard]] std::vector<SpanSolution> solve_untwisted(const PlacedSpan& placed,
                                                        const Problem& problem, SpanOptions options,
                                                        const Equilibrium* shape,
                                                        const Remembered* last,
                                                        SpanWorkspace& workspace);

}  // namespace dlo::energy_model
