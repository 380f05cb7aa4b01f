#pragma once

#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"
#include "problem/split.hpp"
#include "search/untwisted_span.hpp"
#include "span/span_options.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Solves a span between clamps that prescribe frames: from a shape whose twist is known, if there
/// is one; otherwise without twist, after which the clamp is rotated from each stable shape found.
/// The list is never empty, best first.
/// @param start  null: none is known
/// @param memory  of the last call, empty if nothing is to be followed; the shape without twist is
///   updated
[[nodiscard]] std::vector<SpanSolution> solve_twisted(
    const PlacedSpan& placed, const Problem& problem, const SpanOptions& options,
    const Equilibrium* start, RememberedTwist& memory, SpanWorkspace& workspace);

}  // namespace dlo::energy_model
