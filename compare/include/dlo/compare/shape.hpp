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

/// Curvature of a polygon at an inner point [1/m]: its turning angle over joint_length, about the
/// binormal. @param point  from 1 to M - 2
[[nodiscard]] Eigen::Vector3d joint_curvature(const Shape& shape, std::size_t point);

/// Amount of the curvature at all points of a polygon [1/m], M; at an end that of the next joint.
[[nodiscard]] std::vector<double> joint_curvatures(const Shape& shape);

/// Values at other arc lengths, linear between the given ones; beyond the ends those of the ends.
/// @param values  at `from`;  @param from  growing, two or more
[[nodiscard]] std::vector<double> interpolated(const std::vector<double>& values,
                                               const std::vector<double>& from,
                                               const std::vector<double>& to);

/// Points at other arc lengths, on straight lines between the given ones; arc lengths beyond the
/// ends give the end points.
/// @throws std::invalid_argument if the shape has fewer than two points
[[nodiscard]] Shape resample(const Shape& shape, const std::vector<double>& arc_lengths);

/// `count` arc lengths from 0 to `length`, equally spaced [m].
[[nodiscard]] std::vector<double> equal_arc_lengths(double length, int count);

}  // namespace dlo::compare
