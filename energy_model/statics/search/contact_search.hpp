#pragma once

#include "span/found.hpp"
#include "span/span_solver.hpp"

namespace dlo::energy_model {

/// Component of the tangents out of the plane up to which a shape counts as planar.
inline constexpr double planar_tangent_tolerance = 1e-6;

/// Solves a span with rigid obstacles: returns equilibria, best first. A polygon in equilibrium
/// (PenaltyPolygon) determines the initial contacts. The rod's shape is then found with these
/// contacts, whose ends are unknowns (FreeBoundary), and the contacts are updated until the rod is
/// not within an obstacle and no obstacle pulls. `converged` means that certify() and
/// updated_contacts() confirm this and that the contacts end where the rod lifts off. If the
/// contacts do not converge, the shape is not_verified. The list is never empty.
[[nodiscard]] std::vector<SpanSolution> solve_touching_span(const Span& span,
                                                            const SpanOptions& options,
                                                            SpanWorkspace& workspace);

/// Adds equilibria found from shapes that pass the span's obstacles on either side
/// (pinned_past_obstacles()): all of them if all are wanted, otherwise those that may be lower than
/// the lowest one found. Soft obstacles are included.
void search_past_obstacles(const Span& span, const SpanOptions& options, SpanWorkspace& workspace,
                           Found& found);

}  // namespace dlo::energy_model
