#pragma once

#include "span/span_options.hpp"
#include "span/span_workspace.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Solves for the equilibrium near SpanOptions::start and certifies it, by Newton's method or by
/// descent as the start requests, and by the other method if that fails. If a known shape is
/// followed (Approach::follow) or only a descent is allowed, a saddle is replaced by the minimum
/// below it.
[[nodiscard]] SpanSolution solve_from_given_start(const Span& span, const SpanOptions& options,
                                                  SpanWorkspace& workspace);

}  // namespace dlo::energy_model
