#pragma once

#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// The spans of a rod and an equilibrium of each.
struct SolvedRod {
  std::vector<RodSpan> spans;  ///< by growing arc length
  std::vector<SpanEquilibrium> equilibria;

  /// Whether it is one whose directors are followed from end to end.
  [[nodiscard]] bool has_directors() const {
    return spans.front().has_axes || !spans.front().round();
  }
};

/// The rod's equilibrium with its verdict, in the problem's units; `failed` where a span has none.
/// @param tolerance  of the integrator, wherever the shape is sampled
[[nodiscard]] Equilibrium assemble(const Problem& problem, SolvedRod solved, double tolerance);

}  // namespace dlo::energy_model
