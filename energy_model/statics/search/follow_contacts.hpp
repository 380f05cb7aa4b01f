#pragma once

#include "span/span_options.hpp"
#include "span/span_workspace.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Solves for the equilibrium near a known one (SpanOptions::start) of a span whose grips or
/// obstacles have moved a little: Newton's method with its contacts from the extrapolation of the
/// last two shapes, then updates by ActiveSet. There is no search. The result is `followed` if it
/// is stable or a singular point.
[[nodiscard]] SpanSolution follow_contacts(const Span& searched, const SpanOptions& options,
                                           SpanWorkspace& workspace);

}  // namespace dlo::energy_model
