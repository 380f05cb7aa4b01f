#pragma once

#include <optional>

#include "span/local_solver.hpp"

namespace dlo::energy_model {

/// Whether a solution is one of those that are looked for: among all equilibria those that a fold
/// or a bifurcation leaves open count too.
[[nodiscard]] inline bool counts(const SpanSolution& solution, const SpanOptions& options) {
  return solution.is_equilibrium() || (options.wants_all() && solution.is_singular_point());
}

/// Raises the number of terms of an equilibrium until the last ones do not matter any more; where
/// those that can be afforded do not do, with pieces that end where the shape wants it.
/// @param solution  on the span of `on`, its own pieces included
[[nodiscard]] SpanSolution refined(LocalSolver& on, SpanSolution solution);

/// The span with pieces that end where a shape wants it, unless they do so already.
[[nodiscard]] std::optional<Span> adapted_mesh(const LocalSolver& on, const SpanSolution& shape);

/// Certifies a solution. Next to a fold what the terms left out push decides whether there is a
/// shape, and elsewhere it may be most of the error that is told: then it is asked once more, with
/// half as many terms more.
/// @return evaluations that this took, which the solution counts too
int judge(SpanSolution& solution, const SpanOptions& options, SpanWorkspace& workspace);

/// From an equilibrium with too few terms to one with enough, on its own span, and certified.
[[nodiscard]] SpanSolution finish(SpanSolution solution, const SpanOptions& options,
                                  SpanWorkspace& workspace);

}  // namespace dlo::energy_model
