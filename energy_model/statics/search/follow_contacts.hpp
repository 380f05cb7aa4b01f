#pragma once

#include "span/span_options.hpp"
#include "span/span_workspace.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// The equilibrium next to a known one (SpanOptions::start) of a span whose grips or obstacles have
/// moved a little: Newton's method with its contacts from where the last two shapes lead, then as
/// ActiveSet mends them. No search; `followed` where it is stable or a singular point.
[[nodiscard]] SpanSolution follow_contacts(const Span& searched, const SpanOptions& options,
                                           SpanWorkspace& workspace);

}  // namespace dlo::energy_model
