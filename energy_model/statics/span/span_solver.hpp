#pragma once

#include <vector>

#include "span/span_options.hpp"
#include "span/span_workspace.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Equilibria of a span, lowest energy first: the search's best one, or all of them. Never empty; a
/// failure is a single solution that says so.
[[nodiscard]] std::vector<SpanSolution> solve_span(const Span& span, const SpanOptions& options,
                                                   SpanWorkspace& workspace);

}  // namespace dlo::energy_model
