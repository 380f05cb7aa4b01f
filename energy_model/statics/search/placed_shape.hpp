#pragma once

#include <functional>
#include <span>
#include <vector>

#include "dlo/energy_model/problem.hpp"
#include "problem/split.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// A span's shape and its position in space.
struct PlacedShape {
  SpanShape shape;
  bool reversed;
  double start, end;         ///< arc lengths of s = 0 and of the last point in the rod's order [m]
  Eigen::Matrix3d to_space;  ///< rotation from the span's frame
  Eigen::Vector3d anchor;    ///< [m]
  /// Function of s: angle about the span's tangent from SpanShape's d1 to the material's d1 [rad];
  /// empty: the rod has no material directors.
  std::function<double(double)> ahead;
};

/// Returns the placed shape of a solution, without `ahead`.
[[nodiscard]] PlacedShape placed_shape(const PlacedSpan& placed, const SpanSolution& solution,
                                       double length);

/// Sets `ahead` for the shapes of a round straight rod that clamps twist. The torque is constant
/// along a twisted span and rotates the material in proportion to the compliance 1 / GJ. Adjacent
/// spans are not twisted, and their material continues that of the twisted span. Does nothing if no
/// span is twisted.
/// @param shapes, solutions  of all spans, by ascending arc length
void place_twisted_material(const Problem& problem,
                            const std::vector<const SpanSolution*>& solutions,
                            std::vector<PlacedShape>& shapes);

/// Samples the rod at arc lengths; with d1 if all of its shapes have `ahead`.
[[nodiscard]] Samples sample(const std::vector<PlacedShape>& shapes, double length,
                             std::span<const double> arc_lengths);

}  // namespace dlo::energy_model
