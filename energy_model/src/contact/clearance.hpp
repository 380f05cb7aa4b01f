#pragma once

#include <cstddef>
#include <vector>

#include "problem/span.hpp"
#include "strain/span_shape.hpp"

namespace dlo::energy_model {

/// Where a shape comes nearest to a rigid wall, or is deepest behind it.
struct Lowest {
  Span::Wall wall;
  double s = 0;
  double clearance = 0;
};

/// Every local minimum of the clearance over the rod that is below `below`, ends included, by
/// growing s: those of a dense grid, each refined. Grips count.
[[nodiscard]] std::vector<Lowest> lowest_points(const Span& span, const SpanShape& shape,
                                                double below);

}  // namespace dlo::energy_model
