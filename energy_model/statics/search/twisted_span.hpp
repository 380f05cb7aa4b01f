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

/// A span between clamps that hold frames: from a shape whose twist is known, if there is one. Else
/// it is solved without twist, and the clamp is turned from what is stable there. Never empty, best
/// first.
/// @param start null: none is known
/// @param memory of the last call, empty where nothing is to follow it; the shape without twist is
///               renewed
[[nodiscard]] std::vector<SpanSolution> solve_twisted(
    const PlacedSpan& placed, const Problem& problem, const SpanOptions& options,
    const Equilibrium* start, RememberedTwist& memory, SpanWorkspace& workspace);

}  // namespace dlo::energy_model
