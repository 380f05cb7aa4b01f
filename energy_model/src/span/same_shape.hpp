#pragma once

#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Difference of points over the length up to which shapes that Newton's method has found are one.
inline constexpr double same_points = 1e-6;

/// Two equilibria of one span that are the same but for rounding and, in space, for rigid-body
/// modes.
[[nodiscard]] bool is_same_shape(const SpanSolution& a, const SpanSolution& b,
                                 double tolerance = same_points);

/// The order of what is found: stable shapes, other equilibria, the rest, each by energy.
[[nodiscard]] bool is_better(const SpanSolution& a, const SpanSolution& b);

}  // namespace dlo::energy_model
