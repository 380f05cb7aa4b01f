#pragma once

#include <optional>

#include "span/found.hpp"
#include "span/local_solver.hpp"

namespace dlo::energy_model {

/// Raises the number of terms of an equilibrium until the last ones do not matter any more; where
/// those that can be afforded do not do, with pieces that end where the shape wants it.
/// @param solution  on the span of `on`, its own pieces included
[[nodiscard]] SpanSolution refined(LocalSolver& on, SpanSolution solution);

/// The span with pieces that end where a shape wants it, unless they do so already.
[[nodiscard]] std::optional<Span> adapted_mesh(const LocalSolver& on, const SpanSolution& shape);

/// Certified; of evaluations those on the way to a shape count, not its certificate's. Next to a
/// fold what the terms left out push decides whether there is a shape, and elsewhere it may be most
/// of the error that is told: then it is asked once more, with half as many terms more.
[[nodiscard]] SpanSolution judged(SpanSolution solution, const SpanOptions& options,
                                  SpanWorkspace& workspace);

/// From an equilibrium with too few terms to one with enough, on its own span, and certified.
[[nodiscard]] SpanSolution finish(SpanSolution solution, const SpanOptions& options,
                                  SpanWorkspace& workspace);

}  // namespace dlo::energy_model
