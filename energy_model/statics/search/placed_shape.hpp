#pragma once

#include <functional>
#include <span>
#include <vector>

#include "dlo/energy_model/problem.hpp"
#include "problem/split.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// A span's shape and where it lies.
struct PlacedShape {
  SpanShape shape;
  bool reversed;
  double start, end;         ///< arc lengths of s = 0 and of the last point in the rod's order [m]
  Eigen::Matrix3d to_space;  ///< from the span's frame
  Eigen::Vector3d anchor;    ///< [m]
  /// Of s: the angle about the span's tangent by which the material's d1 is turned on from that of
  /// SpanShape [rad]; none: the rod has no material directors to tell.
  std::function<double(double)> ahead;
};

/// Where a span lies, without `ahead`.
[[nodiscard]] PlacedShape placed_shape(const PlacedSpan& placed, const SpanSolution& solution,
                                       double length);

/// Gives the shapes of a round straight rod their `ahead`, where clamps twist it: a torque that is
/// the same all along a twisted span turns the material by its share of the compliance 1 / GJ; what
/// lies beside it is not twisted, and goes on from it. Nothing where no span is twisted.
/// @param shapes, solutions  of all spans, by growing arc length
void place_twisted_material(const Problem& problem,
                            const std::vector<const SpanSolution*>& solutions,
                            std::vector<PlacedShape>& shapes);

/// The rod at arc lengths of it; d1 where all of its shapes have `ahead`.
[[nodiscard]] Samples sample(const std::vector<PlacedShape>& shapes, double length,
                             std::span<const double> arc_lengths);

}  // namespace dlo::energy_model
