#pragma once

#include "span/found.hpp"
#include "span/span_solver.hpp"

namespace dlo::energy_model {

/// Equilibria of a span on rigid obstacles, lowest energy first. What touches what is told by a
/// polygon at rest (PenaltyPolygon); then the rod's own shape is found with these contacts, whose
/// ends are unknowns (FreeBoundary), and the contacts are updated until nothing is behind an
/// obstacle and no obstacle pulls. `converged` says that certify() and updated_contacts() have
/// found that so and that the contacts end where the rod lifts off by itself; else the best shape
/// is not_verified. Never empty.
[[nodiscard]] std::vector<SpanSolution> solve_touching_span(const Span& span,
                                                            const SpanOptions& options,
                                                            SpanWorkspace& workspace);

/// Adds the equilibria that shapes lead to which pass the span's obstacles on either side
/// (held_past_obstacles()): all of them if all are wanted, else those that may be lower than the
/// lowest one found. Of obstacles that yield too.
void look_past_obstacles(const Span& span, const SpanOptions& options, SpanWorkspace& workspace,
                         Found& found);

}  // namespace dlo::energy_model
