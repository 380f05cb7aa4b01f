#pragma once

#include <cstddef>
#include <functional>
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

/// Returns indices of a grid's points, growing: of every coarse interval of `stride` grid intervals
/// an end of which has a clearance of at most `most`, all points. The clearance changes along a rod
/// by no more than the arc length, so that the others have more than `most` less half a coarse
/// interval.
/// @param s           arc lengths of the grid, equally spaced
/// @param clearances  returns the least clearance at each of some arc lengths
[[nodiscard]] std::vector<std::size_t> near_points(
    const std::vector<double>& s, std::size_t stride, double most,
    const std::function<Eigen::VectorXd(const std::vector<double>& s)>& clearances);

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
