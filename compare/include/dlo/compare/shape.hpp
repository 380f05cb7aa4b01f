#pragma once

#include <Eigen/Core>
#include <vector>

namespace dlo::compare {

/// Points of a rod at increasing arc lengths.
struct Shape {
  std::vector<double> arc_length;  ///< [m], M
  Eigen::Matrix3Xd points;         ///< [m], 3 x M
  /// Whether a gripper at s = 0 holds the middle of the first segment, of which the shape contains
  /// only the rod's own half.
  bool half_at_start = false;
  bool half_at_end = false;  ///< whether a gripper at s = l holds the middle of the last segment
};

/// Returns the arc length that a polygon's joint represents [m]: half of both adjacent segments,
/// where segments that grippers hold in the middle count as whole ones.
/// @param point  from 1 to M - 2
[[nodiscard]] double joint_length(const Shape& shape, std::size_t point);

/// Returns the curvature of a polygon at an inner point [1/m]: its turning angle divided by
/// joint_length(), about the binormal.
/// @param point  from 1 to M - 2
[[nodiscard]] Eigen::Vector3d joint_curvature(const Shape& shape, std::size_t point);

/// Returns the absolute curvature at all points of a polygon [1/m], M; an end has the value of the
/// adjacent joint. All are 0 if there are fewer than three points.
[[nodiscard]] std::vector<double> joint_curvatures(const Shape& shape);

/// Interpolates values linearly at other arc lengths; beyond an end the end value is returned.
/// @param values  at `from`;  @param from  increasing, two or more
[[nodiscard]] std::vector<double> interpolated(const std::vector<double>& values,
                                               const std::vector<double>& from,
                                               const std::vector<double>& to);

/// Returns points at other arc lengths, on straight lines between the given ones; arc lengths
/// beyond an end give the end point.
/// @throws std::invalid_argument if the shape has fewer than two points, or not one per arc length
[[nodiscard]] Shape resample(const Shape& shape, const std::vector<double>& arc_lengths);

/// Returns `count` arc lengths from 0 to `length`, equally spaced [m].
/// @throws std::invalid_argument unless length > 0 and count >= 2
[[nodiscard]] std::vector<double> equal_arc_lengths(double length, int count);

}  // namespace dlo::compare
