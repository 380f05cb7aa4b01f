#include "shape/curve.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

double turning_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Returns the distance of a shape's points from the grippers, as the root of the sum of squares
/// [m]. For a gripper beyond the points, the rod between them is subtracted from the distance.
double distance_from_grippers(const Shape& shape, const Scene& scene) {
  double sum = 0;
  const std::vector<double>& s = shape.arc_length;
  for (const Gripper& gripper : scene.grippers) {
    const double at = std::clamp(gripper.at, s.front(), s.back());
    const Eigen::Vector3d there = resample(shape, {at}).points.col(0);
    const double beyond = std::abs(gripper.at - at);
    const double distance = std::max(0.0, (there - gripper.position).norm() - beyond);
    sum += distance * distance;
  }
  return std::sqrt(sum);
}

/// Returns the shape with arc lengths l - s in growing order, for a file that runs from l to 0.
Shape reversed(const Shape& shape, double length) {
  Shape result;
  result.points = shape.points.rowwise().reverse();
  result.arc_length.assign(shape.arc_length.rbegin(), shape.arc_length.rend());
  for (double& s : result.arc_length) s = std::max(0.0, length - s);
  return result;
}

/// Removes points until the arc lengths increase strictly; the first point of each arc length
/// stays.
Shape without_repeated_lengths(const Shape& shape) {
  Shape result;
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < shape.arc_length.size(); ++i) {
    if (!kept.empty() && !(shape.arc_length[i] > result.arc_length.back())) continue;
    kept.push_back(static_cast<Eigen::Index>(i));
    result.arc_length.push_back(shape.arc_length[i]);
  }
  result.points = shape.points(Eigen::all, kept);
  return result;
}

constexpr Eigen::Index curve_elements = 200;

}  // namespace

Shape aligned_by_grippers(const MeasuredShape& shape, const Scene& scene, ArcLengths rule) {
  constexpr double whole_rod_slack = 0.03;
  constexpr int places_along = 21;
  const double length = scene.length;
  Shape along;
  if (rule == ArcLengths::file) {
    along = shape_of_file(shape, length);
  } else {
    along.points = shape.points;
    along.arc_length = arc_lengths_along(shape.points);
    const double total = along.arc_length.back();
    const bool whole = rule == ArcLengths::chord || total > (1 - whole_rod_slack) * length;
    for (double& s : along.arc_length) s = std::min(whole ? s / total * length : s, length);
  }
  const bool moves = rule != ArcLengths::file && along.arc_length.back() < length;
  const double slack = moves ? length - along.arc_length.back() : 0;
  const int places = slack > 0 ? places_along : 1;
  Shape best;
  double least = std::numeric_limits<double>::infinity();
  for (int place = 0; place < places; ++place) {
    Shape moved = along;
    const double offset = places > 1 ? slack * place / (places - 1) : 0;
    for (double& s : moved.arc_length) s = std::min(s + offset, length);
    for (const Shape& laid : {moved, reversed(moved, length)}) {
      const double distance = distance_from_grippers(laid, scene);
      if (!(distance < least)) continue;
      least = distance;
      best = laid;
    }
  }
  return without_repeated_lengths(best);
}

ArcLengths arc_length_rule(const MeasuredShape& shape, ArcLengths asked) {
  if (asked != ArcLengths::automatic) return asked;
  return shape.arc_length.empty() ? ArcLengths::nearest : ArcLengths::file;
}

Shape shape_of_file(const MeasuredShape& shape, double length) {
  if (shape.arc_length.empty()) {
    throw InputError(fmt::format(
        "{}: no arc lengths in it (allowed: a column s, or arc lengths by chord or nearest)",
        shape.file));
  }
  Shape along{shape.arc_length, shape.points};
  std::vector<double>& s = along.arc_length;
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
  if (s.front() > s.back()) {
    std::reverse(s.begin(), s.end());
    along.points = shape.points.rowwise().reverse();
  }
  return along;
}

double polyline_length(const Eigen::Matrix3Xd& points) { return chord_lengths(points).sum(); }

Eigen::VectorXd chord_lengths(const Eigen::Matrix3Xd& points) {
  const Eigen::Index n = points.cols() - 1;
  return (points.rightCols(n) - points.leftCols(n)).colwise().norm();
}

std::vector<double> arc_lengths_along(const Eigen::Matrix3Xd& points) {
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
  constexpr double tolerance = 0.1;
  const Eigen::Index segments = points.cols() - 1;
  const Eigen::VectorXd lengths = chord_lengths(points);
  const double whole = arc_lengths_along(points).back();
  const double segment = whole / static_cast<double>(segments);
  return segments > 2 && lengths.maxCoeff() < (1 + tolerance) * lengths.minCoeff() &&
         std::abs(length - whole - segment) < tolerance * segment;
}

Curve::Curve(const Reference& reference, double length)
    : length_(length), step_(length / static_cast<double>(curve_elements)) {
  std::vector<double> s(static_cast<std::size_t>(curve_elements) + 1);
  for (std::size_t i = 0; i < s.size(); ++i) s[i] = static_cast<double>(i) * step_;
  s.back() = length;
  energy_model::Samples samples = reference(s);
  nodes_ = std::move(samples.points);
  tangents_ = std::move(samples.tangents);
}

Curve::Local Curve::at(double s) const {
  const auto piece =
      std::clamp(static_cast<Eigen::Index>(s / step_), Eigen::Index{0}, curve_elements - 1);
  const double u = s / step_ - static_cast<double>(piece);
  const Eigen::Vector3d a = nodes_.col(piece);
  const Eigen::Vector3d ta = step_ * tangents_.col(piece);
  const Eigen::Vector3d tb = step_ * tangents_.col(piece + 1);
  const Eigen::Vector3d chord = nodes_.col(piece + 1) - a;
  const Eigen::Vector3d c2 = 3 * chord - 2 * ta - tb;
  const Eigen::Vector3d c3 = ta + tb - 2 * chord;
  return {a + u * (ta + u * (c2 + u * c3)), (ta + u * (2 * c2 + u * 3 * c3)) / step_,
          (2 * c2 + u * 6 * c3) / (step_ * step_)};
}

Eigen::Matrix3Xd Curve::points(const std::vector<double>& s) const {
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(s.size()));
  for (std::size_t i = 0; i < s.size(); ++i) result.col(static_cast<Eigen::Index>(i)) = point(s[i]);
  return result;
}

double Curve::nearest(const Eigen::Vector3d& position, double s) const {
  // Newton's method for (position - r) . r' = 0, with descent, limited to four intervals per step.
  constexpr int most_steps = 30;
  Local local = at(s);
  double distance = (position - local.point).squaredNorm();
  for (int i = 0; i < most_steps; ++i) {
    const Eigen::Vector3d gap = position - local.point;
    const double slope = gap.dot(local.tangent);
    const double curvature = std::max(local.tangent.squaredNorm() - gap.dot(local.second), 0.2);
    double move = std::clamp(slope / curvature, -4 * step_, 4 * step_);
    bool moved = false;
    for (int halving = 0; halving < 8 && !moved; ++halving, move /= 2) {
      const double next = std::clamp(s + move, 0.0, length_);
      if (std::abs(next - s) < 1e-13 * length_) return s;
      const Local next_local = at(next);
      const double next_distance = (position - next_local.point).squaredNorm();
      if (!(next_distance < distance)) continue;
      s = next;
      local = next_local;
      distance = next_distance;
      moved = true;
    }
    if (!moved) return s;
  }
  return s;
}

std::vector<double> Curve::nearest_in_order(const Eigen::Matrix3Xd& positions) const {
  const Eigen::Index count = positions.cols();
  constexpr Eigen::Index node_count = curve_elements + 1;
  // sums[g]: least sum of squares with the last point so far at node g; from: node of its
  // predecessor
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(node_count);
  std::vector<std::uint16_t> from(static_cast<std::size_t>(count * node_count));
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::RowVectorXd distance =
        (nodes_.colwise() - positions.col(i)).colwise().squaredNorm();
    double best = std::numeric_limits<double>::infinity();
    std::uint16_t best_node = 0;
    std::uint16_t* row = from.data() + i * node_count;
    for (Eigen::Index g = 0; g < node_count; ++g) {
      if (sums[g] < best) {
        best = sums[g];
        best_node = static_cast<std::uint16_t>(g);
      }
      row[g] = best_node;
      sums[g] = best + distance[g];
    }
  }
  std::vector<double> result(static_cast<std::size_t>(count));
  Eigen::Index node = 0;
  sums.minCoeff(&node);
  for (Eigen::Index i = count - 1; i >= 0; --i) {
    const double s = std::min(static_cast<double>(node) * step_, length_);
    const double moved = nearest(positions.col(i), s);
    result[static_cast<std::size_t>(i)] = std::clamp(moved, s - step_, s + step_);
    node = from[static_cast<std::size_t>(i * node_count + node)];
  }
  return result;
}

}  // namespace dlo::compare
