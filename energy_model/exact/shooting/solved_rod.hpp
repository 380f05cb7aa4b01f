#pragma once

#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// The spans of a rod, and an equilibrium of each.
struct SolvedRod {
  std::vector<RodSpan> spans;  ///< by growing arc length
  std::vector<SpanEquilibrium> equilibria;

  /// Whether the rod is a single span whose directors are integrated from end to end.
  [[nodiscard]] bool has_directors() const {
    return spans.front().has_axes || !spans.front().round();
  }
};

/// Combines the spans to an equilibrium of the rod with its status, in the problem's units;
/// `failed` if a span has none.
/// @param tolerance  local error of the integrator, also for later samples of the shape
[[nodiscard]] Equilibrium assemble(const Problem& problem, SolvedRod solved, double tolerance);

}  // namespace dlo::energy_model
