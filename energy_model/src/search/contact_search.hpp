#pragma once

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

}  // namespace dlo::energy_model
