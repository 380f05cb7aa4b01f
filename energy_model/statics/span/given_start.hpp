#pragma once

#include "span/span_options.hpp"
#include "span/span_workspace.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// The equilibrium next to SpanOptions::start, certified: by Newton's method, or downhill, as it
/// says, and the other way where that leads to none. A shape that is followed is gone on with to
/// where a descent from a saddle ends.
[[nodiscard]] SpanSolution solve_from_given_start(const Span& span, const SpanOptions& options,
                                                  SpanWorkspace& workspace);

}  // namespace dlo::energy_model
