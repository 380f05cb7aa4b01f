#pragma once

#include <Eigen/Core>
#include <vector>

namespace dlo::compare {

/// Points of a rod at growing arc lengths.
struct Shape {
  std::vector<double> arc_length;  ///< [m], M
  Eigen::Matrix3Xd points;         ///< [m], 3 x M
  bool half_at_start = false;      ///< a gripper at s = 0 holds the middle of the first segment, of
                                   ///< which only the rod's own half is here
  bool half_at_end = false;        ///< the same of the last segment
};

/// Arc length over which a polygon turns at an inner point: half of both its segments [m], those
/// that grippers hold in their middle counted whole.
/// @param point  from 1 to M - 2
[[nodiscard]] double joint_length(const Shape& shape, std::size_t point);

/// Points at other arc lengths, on straight lines between the given ones; arc lengths beyond the
/// ends give the end points.
/// @throws std::invalid_argument if the shape has fewer than two points
[[nodiscard]] Shape resample(const Shape& shape, const std::vector<double>& arc_lengths);

/// `count` arc lengths from 0 to `length`, equally spaced [m].
[[nodiscard]] std::vector<double> equal_arc_lengths(double length, int count);

}  // namespace dlo::compare
