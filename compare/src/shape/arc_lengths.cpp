#include "shape/arc_lengths.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"

namespace dlo::compare {
namespace {

double turning_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

ArcLengths arc_length_rule(const MeasuredShape& shape, ArcLengths asked) {
  if (asked != ArcLengths::automatic) return asked;
  return shape.arc_length.empty() ? ArcLengths::nearest : ArcLengths::file;
}

std::vector<double> file_arc_lengths(const MeasuredShape& shape, double length) {
  if (shape.arc_length.empty()) {
    throw InputError(fmt::format(
        "{}: no arc lengths in it (allowed: a column s, or arc lengths by chord or nearest)",
        shape.file));
  }
  std::vector<double> s = shape.arc_length;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const std::optional<double> at = on_rod(s[i], length);
    if (!at) {
      throw InputError(
          fmt::format("{}: point {}: s = {:g} m (allowed: 0 to {:g} m, the rod; "
                      "--unit if the file is not in metres)",
                      shape.file, i + 1, s[i], length));
    }
    s[i] = *at;
  }
  return s;
}

double polyline_length(const Eigen::Matrix3Xd& points) {
  return (points.rightCols(points.cols() - 1) - points.leftCols(points.cols() - 1))
      .colwise()
      .norm()
      .sum();
}

std::vector<double> lengths_along(const Eigen::Matrix3Xd& points) {
  const Eigen::Index count = points.cols();
  const Eigen::Matrix3Xd chords = points.rightCols(count - 1) - points.leftCols(count - 1);
  const Eigen::VectorXd d = chords.colwise().norm().transpose();
  Eigen::VectorXd curvature = Eigen::VectorXd::Zero(count);
  for (Eigen::Index i = 1; i + 1 < count; ++i) {
    curvature[i] = 2 * turning_angle(chords.col(i - 1), chords.col(i)) / (d[i - 1] + d[i]);
  }
  if (count > 2) {
    curvature[0] = curvature[1];
    curvature[count - 1] = curvature[count - 2];
  }
  std::vector<double> result(static_cast<std::size_t>(count), 0.0);
  for (Eigen::Index i = 0; i + 1 < count; ++i) {
    const double turn = d[i] * (curvature[i] + curvature[i + 1]) / 2;
    result[static_cast<std::size_t>(i) + 1] =
        result[static_cast<std::size_t>(i)] + d[i] * (1 + turn * turn / 24);
  }
  return result;
}

bool lacks_one_segment(const Eigen::Matrix3Xd& points, double length) {
  constexpr double alike = 0.1;
  const Eigen::Index segments = points.cols() - 1;
  const Eigen::VectorXd lengths =
      (points.rightCols(segments) - points.leftCols(segments)).colwise().norm().transpose();
  const double whole = lengths_along(points).back();
  const double segment = whole / static_cast<double>(segments);
  return segments > 2 && lengths.maxCoeff() < (1 + alike) * lengths.minCoeff() &&
         std::abs(length - whole - segment) < alike * segment;
}

}  // namespace dlo::compare
