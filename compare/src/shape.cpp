#include "dlo/compare/shape.hpp"

#include <algorithm>
#include <stdexcept>

namespace dlo::compare {

double joint_length(const Shape& shape, std::size_t point) {
  const std::vector<double>& s = shape.arc_length;
  double before = s[point] - s[point - 1];
  double after = s[point + 1] - s[point];
  if (shape.half_at_start && point == 1) before *= 2;
  if (shape.half_at_end && point + 2 == s.size()) after *= 2;
  return (before + after) / 2;
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
    const auto above = std::upper_bound(s.begin() + 1, s.end() - 1, arc_lengths[i]);
    const auto right = static_cast<Eigen::Index>(above - s.begin());
    const double left_s = *(above - 1);
    const double share = std::clamp((arc_lengths[i] - left_s) / (*above - left_s), 0.0, 1.0);
    result.points.col(static_cast<Eigen::Index>(i)) =
        (1 - share) * shape.points.col(right - 1) + share * shape.points.col(right);
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
