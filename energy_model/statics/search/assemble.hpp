#pragma once

#include <functional>
#include <span>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"
#include "problem/split.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// A span's shape and its position in space.
struct PlacedShape {
  SpanShape shape;
  bool reversed;
  double start;              ///< arc length of s = 0 [m]
  double end;                ///< arc length of the last point in the rod's order [m]
  Eigen::Matrix3d to_space;  ///< rotation from the span's frame
  Eigen::Vector3d anchor;    ///< [m]
  /// Function of s: angle about the span's tangent from SpanShape's d1 to the material's d1 [rad];
  /// empty for a round straight rod that clamps do not twist, or of which a span has no shape.
  std::function<double(double)> ahead;
};

/// Samples the rod at arc lengths [m]; with d1 if its first shape has `ahead`.
/// @param length  of the rod [m]
[[nodiscard]] Samples sample(const std::vector<PlacedShape>& shapes, double length,
                             std::span<const double> arc_lengths);

/// Assembles one solution of each span into an equilibrium of the rod, in space and SI units.
[[nodiscard]] Equilibrium assemble(const Problem& problem, const std::vector<PlacedSpan>& placed,
                                   const std::vector<const SpanSolution*>& solutions);

}  // namespace dlo::energy_model
