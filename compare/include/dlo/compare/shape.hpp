#pragma once

#include <Eigen/Core>
#include <vector>

namespace dlo::compare {

/// Points of a rod at growing arc lengths.
struct Shape {
  std::vector<double> arc_length;  ///< [m], M
  Eigen::Matrix3Xd points;         ///< [m], 3 x M
};

/// Points at other arc lengths, on straight lines between the given ones; arc lengths beyond the
/// ends give the end points.
/// @throws std::invalid_argument if the shape has fewer than two points
[[nodiscard]] Shape resample(const Shape& shape, const std::vector<double>& arc_lengths);

/// `count` arc lengths from 0 to `length`, equally spaced [m].
[[nodiscard]] std::vector<double> equal_arc_lengths(double length, int count);

}  // namespace dlo::compare
