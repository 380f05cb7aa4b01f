#include "dlo/compare/shape.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dlo::compare {
namespace {

/// Position of an arc length between two neighbours of a sorted list.
struct Bracket {
  std::size_t right;  // index of the upper neighbour
  double share;       // fraction of the interval from the lower neighbour, 0 to 1
};

Bracket bracket_of(const std::vector<double>& s, double at) {
  const auto above = std::upper_bound(s.begin() + 1, s.end() - 1, at);
  const double left = *(above - 1);
  const double step = *above - left;  // 0 for two points at the rod's end
  return {static_cast<std::size_t>(above - s.begin()),
          step > 0 ? std::clamp((at - left) / step, 0.0, 1.0) : 0};
}

}  // namespace

double joint_length(const Shape& shape, std::size_t point) {
  const std::vector<double>& s = shape.arc_length;
  double before = s[point] - s[point - 1];
  double after = s[point + 1] - s[point];
  if (shape.half_at_start && point == 1) before *= 2;
  if (shape.half_at_end && point + 2 == s.size()) after *= 2;
  return (before + after) / 2;
}

Eigen::Vector3d joint_curvature(const Shape& shape, std::size_t point) {
  const auto column = static_cast<Eigen::Index>(point);
  const Eigen::Vector3d before = shape.points.col(column) - shape.points.col(column - 1);
  const Eigen::Vector3d after = shape.points.col(column + 1) - shape.points.col(column);
  const Eigen::Vector3d binormal = before.cross(after);
  const double angle = std::atan2(binormal.norm(), before.dot(after));
  return binormal.normalized() * angle / joint_length(shape, point);
}

std::vector<double> joint_curvatures(const Shape& shape) {
  const std::size_t count = shape.arc_length.size();
  std::vector<double> result(count, 0.0);
  if (count < 3) return result;
  for (std::size_t i = 1; i + 1 < count; ++i) result[i] = joint_curvature(shape, i).norm();
  result.front() = result[1];
  result.back() = result[count - 2];
  return result;
}

std::vector<double> interpolated(const std::vector<double>& values, const std::vector<double>& from,
                                 const std::vector<double>& to) {
  std::vector<double> result;
  result.reserve(to.size());
  for (const double s : to) {
    const Bracket bracket = bracket_of(from, s);
    result.push_back((1 - bracket.share) * values[bracket.right - 1] +
                     bracket.share * values[bracket.right]);
  }
  return result;
}

Shape resample(const Shape& shape, const std::vector<double>& arc_lengths) {
  const std::vector<double>& s = shape.arc_length;
  if (s.size() < 2 || static_cast<std::size_t>(shape.points.cols()) != s.size()) {
    throw std::invalid_argument("resample: a shape needs two or more points, one per arc length");
  }
  Shape result;
  result.arc_length = arc_lengths;
  result.points.resize(3, static_cast<Eigen::Index>(arc_lengths.size()));
  for (std::size_t i = 0; i < arc_lengths.size(); ++i) {
    const Bracket bracket = bracket_of(s, arc_lengths[i]);
    const auto right = static_cast<Eigen::Index>(bracket.right);
    result.points.col(static_cast<Eigen::Index>(i)) =
        (1 - bracket.share) * shape.points.col(right - 1) + bracket.share * shape.points.col(right);
  }
  return result;
}

std::vector<double> equal_arc_lengths(double length, int count) {
  if (!(length > 0) || count < 2) {
    throw std::invalid_argument("equal_arc_lengths: needs a length > 0 and two or more points");
  }
  std::vector<double> result(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    result[static_cast<std::size_t>(i)] = i + 1 == count ? length : length * i / (count - 1);
  }
  return result;
}

}  // namespace dlo::compare
