#pragma once

#include <vector>

#include "span/span_options.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Solves a span: returns the best solution of the search and the other stable ones, or all
/// equilibria, best first. From SpanOptions::start it returns the one of solve_from_given_start().
/// The list is never empty; a failure is a single solution whose message gives the reason.
[[nodiscard]] std::vector<SpanSolution> solve_span(const Span& span, const SpanOptions& options,
                                                   SpanWorkspace& workspace);

}  // namespace dlo::energy_model
