#pragma once

#include <cstddef>
#include <vector>

#include "frames/span_shape.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

/// Clearance of a point of a shape, and its derivatives by the arc length.
struct Clearance {
  double value = 0;
  double slope = 0;
  double rate = 0;  ///< of the slope
};
[[nodiscard]] Clearance clearance_at(const obstacle::Body& body, const SpanSamples& samples,
                                     Eigen::Index i);

/// Where a shape comes nearest to a rigid obstacle, or is deepest behind it.
struct GapMinimum {
  Span::Obstacle obstacle;
  double s = 0;
  double clearance = 0;
  int feature = 0;  ///< of the body, next to it
};

/// Every local minimum of the clearance over the rod that is below `below`, ends included, by
/// growing s: those of a dense grid, each refined. Grips count.
[[nodiscard]] std::vector<GapMinimum> gap_minima(const Span& span, const SpanShape& shape,
                                                 double below);

}  // namespace dlo::energy_model
