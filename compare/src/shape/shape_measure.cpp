#include "shape/shape_measure.hpp"

#include <algorithm>
#include <cmath>

#include "dlo/compare/deviation.hpp"
#include "shape/curve.hpp"

namespace dlo::compare {
namespace {

/// Axial strain up to which a segment is weighted by the rod's arc length alone [-].
constexpr double counted_stretch = 0.01;
/// Distance from an end, as a share of the length, up to which an arc length is at the end. It is
/// the accuracy with which nearest points are found.
constexpr double end_rounding = 1e-9;

enum class RodEnd { start, end };

/// Returns for each point how far the points up to it extend past the rod's end [m]: the running
/// maximum of the distances from the end, beginning at the innermost point whose nearest point is
/// the end; 0 for points whose nearest point is on the rod.
std::vector<double> overshoot_distances(const std::vector<double>& s,
                                        const Eigen::Matrix3Xd& points, double end, double rounding,
                                        const Eigen::Vector3d& rod_end, RodEnd side) {
  std::vector<double> past(s.size(), 0.0);
  double largest = 0;
  for (std::size_t k = 0; k < s.size(); ++k) {
    const std::size_t i = side == RodEnd::start ? k : s.size() - 1 - k;
    if (std::abs(s[i] - end) > rounding) break;
    past[i] = (points.col(static_cast<Eigen::Index>(i)) - rod_end).norm();
  }
  // Running maximum, from the innermost to the outermost point.
  for (std::size_t k = s.size(); k-- > 0;) {
    const std::size_t i = side == RodEnd::start ? k : s.size() - 1 - k;
    if (past[i] == 0) continue;
    largest = std::max(largest, past[i]);
    past[i] = largest;
  }
  return past;
}

/// Returns the value at `x` of the polynomial through the reference points at the arc lengths
/// s[nodes].
Eigen::Vector3d interpolated_point(const std::vector<double>& s, const Eigen::Matrix3Xd& points,
                                   const std::vector<std::size_t>& nodes, double x) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::size_t i : nodes) {
    double factor = 1;
    for (const std::size_t j : nodes) {
      if (j != i) factor *= (x - s[j]) / (s[i] - s[j]);
    }
    sum += factor * points.col(static_cast<Eigen::Index>(i));
  }
  return sum;
}

}  // namespace

Eigen::VectorXd point_weights(const std::vector<double>& s, const Eigen::Matrix3Xd& points) {
  const auto count = static_cast<Eigen::Index>(s.size());
  Eigen::VectorXd result = Eigen::VectorXd::Zero(count);
  for (Eigen::Index i = 0; i + 1 < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double own = (points.col(i + 1) - points.col(i)).norm() / (1 + counted_stretch);
    const double share = std::max(s[at + 1] - s[at], own) / 2;
    result[i] += share;
    result[i + 1] += share;
  }
  const double total = result.sum();
  if (!(total > 0)) return Eigen::VectorXd::Constant(count, 1 / static_cast<double>(count));
  return result / total;
}

Measured measure(const Alignment& alignment, const Reference& reference, double length) {
  const Shape& shape = alignment.shape;
  Measured result;
  result.arc_length = shape.arc_length;
  std::vector<double>& s = result.arc_length;
  if (alignment.arc_lengths == ArcLengths::nearest) {
    const double rounding = end_rounding * length;
    const Eigen::Matrix3Xd ends = reference(std::vector<double>{0, length}).points;
    std::vector<double> before =
        overshoot_distances(s, shape.points, 0, rounding, ends.col(0), RodEnd::start);
    std::vector<double> after =
        overshoot_distances(s, shape.points, length, rounding, ends.col(1), RodEnd::end);
    const double covered = s.back() - s.front();
    const double longer = std::max(0.0, polyline_length(shape.points) - covered);
    const double past = before.front() + after.back();
    // The part of `past` that counts as excess is at most the excess length of the polyline. The
    // rest is the deviation of a shape whose points lie past an end although its length is that of
    // the rod.
    const double share = past > longer ? longer / past : 1;
    result.excess_at_start_m = share * before.front();
    result.excess_at_end_m = share * after.back();
    const double begin = s.front();
    const double whole = covered + share * past;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const double along = s[i] - begin + share * (before.front() - before[i] + after[i]);
      s[i] = whole > 0 ? std::clamp(begin + along * (covered / whole), 0.0, length) : begin;
    }
  }
  result.reference = reference(s).points;
  const Eigen::VectorXd squares =
      (shape.points - result.reference).colwise().squaredNorm().transpose();
  result.max_m = std::sqrt(squares.maxCoeff(&result.worst));
  // A mean cannot exceed the maximum, except by rounding.
  result.rms_m = std::min(result.max_m, std::sqrt(squares.dot(point_weights(s, shape.points))));
  return result;
}

WholeRod whole_rod_distances(const Measured& measured, const Alignment& alignment,
                             const Reference& reference, double length) {
  const std::vector<double>& s = measured.arc_length;
  const Eigen::Matrix3Xd& points = alignment.shape.points;
  double covered = s.back() - s.front();
  double sum = measured.rms_m * measured.rms_m * covered;
  WholeRod whole;
  whole.max_m = measured.max_m;
  const auto add = [&](double from, double to, const Eigen::Vector3d& outermost) {
    if (!(to > from)) return;
    constexpr int samples = 65;
    std::vector<double> missing = equal_arc_lengths(to - from, samples);
    for (double& at : missing) at = std::min(at + from, to);
    const Eigen::Matrix3Xd gaps = reference(missing).points.colwise() - outermost;
    const double part = rms(missing, gaps);
    sum += part * part * (to - from);
    covered += to - from;
    whole.max_m = std::max(whole.max_m, std::sqrt(gaps.colwise().squaredNorm().maxCoeff()));
  };
  add(0, s.front(), points.leftCols<1>());
  add(s.back(), length, points.rightCols<1>());
  whole.rms_m = std::min(whole.max_m, std::sqrt(sum / covered));
  return whole;
}

std::vector<RodPart> intervals_between_points(const std::vector<double>& s,
                                              const Reference& reference, double length) {
  constexpr double least_part = 1e-3;
  constexpr double least_distance = 0.1;
  std::vector<RodPart> result;
  std::vector<double> middle;
  const Eigen::Matrix3Xd points = reference(s).points;
  std::vector<std::vector<std::size_t>> nodes;
  for (std::size_t i = 0; i + 1 < s.size(); ++i) {
    const double gap = s[i + 1] - s[i];
    if (!(gap > least_part * length)) continue;
    std::vector<std::size_t> around = {i, i + 1};
    for (std::size_t j = i; j-- > 0;) {
      if (s[i] - s[j] < least_distance * gap) continue;
      around.push_back(j);
      break;
    }
    for (std::size_t j = i + 2; j < s.size(); ++j) {
      if (s[j] - s[i + 1] < least_distance * gap) continue;
      around.push_back(j);
      break;
    }
    middle.push_back((s[i] + s[i + 1]) / 2);
    nodes.push_back(std::move(around));
    result.push_back({.from_m = s[i], .to_m = s[i + 1]});
  }
  if (middle.empty()) return result;
  const Eigen::Matrix3Xd expected = reference(middle).points;
  for (std::size_t k = 0; k < middle.size(); ++k) {
    const Eigen::Vector3d interpolated = interpolated_point(s, points, nodes[k], middle[k]);
    result[k].interpolation_error_m =
        (interpolated - expected.col(static_cast<Eigen::Index>(k))).norm();
  }
  return result;
}

}  // namespace dlo::compare
