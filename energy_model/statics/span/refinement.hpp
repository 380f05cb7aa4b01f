#pragma once

#include <optional>

#include "span/found.hpp"
#include "span/local_solver.hpp"

namespace dlo::energy_model {

/// Maximum number of rounds that determine the contacts of a shape and their ends.
inline constexpr int most_contact_rounds = 16;

/// Raises the number of coefficients of an equilibrium until the last ones are negligible; if the
/// affordable number is not enough, continues on an adapted mesh. A shape whose last coefficients
/// stay too large becomes `failed`, or `time_limit`; a solution that is no equilibrium is returned
/// unchanged.
/// @param solution  on the span of `on`, with the same elements
[[nodiscard]] SpanSolution refine(LocalSolver& on, SpanSolution solution);

/// Returns the span with a mesh adapted to a shape; std::nullopt if its mesh is already adapted, if
/// nothing is to be cut, and for obstacles, material directors or a given number of coefficients.
[[nodiscard]] std::optional<Span> adapted_mesh(const LocalSolver& on, const SpanSolution& shape);

/// Certifies a solution, without counting the evaluations of the certificate. Near a fold
/// truncation decides whether the shape exists, and elsewhere it may dominate the error estimate.
/// In these cases the shape is solved and certified once more with half as many coefficients more,
/// whose evaluations count, unless options.terms is given, the time is up or there would be too
/// many unknowns. The second solution is returned if it is more accurate, or if only it is an
/// equilibrium.
[[nodiscard]] SpanSolution certified_solution(SpanSolution solution, const SpanOptions& options,
                                              SpanWorkspace& workspace);

/// Refines an equilibrium with too few coefficients, on its own span, and certifies it.
[[nodiscard]] SpanSolution finish(SpanSolution solution, const SpanOptions& options,
                                  SpanWorkspace& workspace);

/// Fits the shape of a solution, by its tangents, on a span with other elements. The result is not
/// an equilibrium yet.
[[nodiscard]] SpanSolution fit_to_elements(LocalSolver& on, const SpanSolution& solution,
                                           int terms);

}  // namespace dlo::energy_model
