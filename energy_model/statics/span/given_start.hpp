#pragma once

#include "span/span_options.hpp"
#include "span/span_workspace.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Solves for the equilibrium near SpanOptions::start and certifies it, by Newton's method or by
/// descent as the start requests, and by the other method if that fails. A saddle is
/// replaced by the equilibrium below it, if that is stable, in two cases: only a descent is allowed
/// (Approach::descend_only), or the start is a known shape and not Approach::follow_only.
[[nodiscard]] SpanSolution solve_from_given_start(const Span& span, const SpanOptions& options,
                                                  SpanWorkspace& workspace);

}  // namespace dlo::energy_model
