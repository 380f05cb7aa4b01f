#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "base/spin.hpp"
#include "dlo/energy_model/turns.hpp"

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

/// Computes Gauss's integral over two segments, ab and cd: the solid angle of the directions from
/// which they appear to cross [rad]. Returns 0 for segments in one plane, for which the sign of the
/// triple product would be rounding.
double crossing_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                      const Eigen::Vector3d& d) {
  const Eigen::Vector3d ac = c - a;
  const Eigen::Vector3d ad = d - a;
  const Eigen::Vector3d bc = c - b;
  const Eigen::Vector3d bd = d - b;
  constexpr double coplanar_tolerance = 1e-9;  // relative size of the triple product
  const double side = (d - c).cross(b - a).dot(ac);
  if (!(std::abs(side) > coplanar_tolerance * (d - c).norm() * (b - a).norm() * ac.norm()))
    return 0;
  std::array<Eigen::Vector3d, 4> normals = {ac.cross(ad), ad.cross(bd), bd.cross(bc), bc.cross(ac)};
  for (Eigen::Vector3d& normal : normals) normal.normalize();
  double angle = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    angle += std::asin(std::clamp(normals[k].dot(normals[(k + 1) % 4]), -1.0, 1.0));
  }
  return std::copysign(angle, side);
}

/// Whether the half-line from `from` along `direction` passes the segment ab at less than
/// `distance`, farther than `distance` from its start.
bool passes(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, const Eigen::Vector3d& a,
            const Eigen::Vector3d& b, double distance) {
  const Eigen::Vector3d to_a = part_across(a - from, direction);
  const Eigen::Vector3d side = part_across(b - a, direction);
  const double squared = side.squaredNorm();
  const double t = squared > 0 ? std::clamp(-to_a.dot(side) / squared, 0.0, 1.0) : 0.0;
  const double along = (a + t * (b - a) - from).dot(direction);
  return along > distance && (to_a + t * side).norm() < distance;
}

/// Returns the signed area of the triangle of three unit vectors on the sphere [rad].
double spherical_area(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                      const Eigen::Vector3d& c) {
  return 2 * std::atan2(a.dot(b.cross(c)), 1 + a.dot(b) + b.dot(c) + c.dot(a));
}

/// Returns Fuller's area divided by 2 pi, between the tangents and the great circle that joins the
/// end ones. It is the writhe if all tangents are in the half sphere about the middle of the end
/// tangents; empty otherwise.
std::optional<double> writhe_of_graph(const Eigen::Matrix3Xd& tangents) {
  constexpr double least = 1e-3;  // smallest cosine between a tangent and the middle
  const Eigen::Vector3d middle = (tangents.leftCols<1>() + tangents.rightCols<1>()).normalized();
  if (!((middle.transpose() * tangents).minCoeff() > least)) return std::nullopt;
  double area = 0;
  for (Eigen::Index i = 0; i + 1 < tangents.cols(); ++i) {
    area += spherical_area(middle, tangents.col(i), tangents.col(i + 1));
  }
  return area / (2 * pi);
}

double length_of(const Eigen::Matrix3Xd& points) {
  const Eigen::Index segments = points.cols() - 1;
  return (points.rightCols(segments) - points.leftCols(segments)).colwise().norm().sum();
}

/// Computes Gauss's integral of a polygon and the lines beyond its ends; empty if a line passes
/// through the polygon.
std::optional<double> gauss_integral(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& first,
                                     const Eigen::Vector3d& last) {
  const Eigen::Index size = points.cols();
  const double length = length_of(points);
  const double far = 1e4 * length;
  const double near = 1e-6 * length;
  Eigen::Matrix3Xd all(3, size + 2);
  all << points.col(0) - far * first, points, points.col(size - 1) + far * last;
  for (Eigen::Index i = 1; i < size; ++i) {
    if (passes(points.col(0), -first, all.col(i + 1), all.col(i + 2), near)) return std::nullopt;
    if (passes(points.col(size - 1), last, all.col(i - 1), all.col(i), near)) return std::nullopt;
  }
  double angle = 0;
  for (Eigen::Index i = 0; i + 1 < all.cols(); ++i) {
    for (Eigen::Index j = i + 2; j + 1 < all.cols(); ++j) {
      angle += crossing_angle(all.col(i), all.col(i + 1), all.col(j), all.col(j + 1));
    }
  }
  return angle / (2 * pi);
}

/// Returns the number of a class modulo two that is nearest to Gauss's integral; empty if the two
/// nearest are about equally near, as for a curve that intersects itself.
std::optional<double> nearest_of_class(double modulo_two, std::optional<double> integral) {
  constexpr double largest_remainder = 0.6;
  if (!integral) return std::nullopt;
  const double remainder = std::remainder(*integral - modulo_two, 2);
  if (std::abs(remainder) > largest_remainder) return std::nullopt;
  return *integral - remainder;
}

/// Returns the tangents of the segments of a polygon and of its ends.
Eigen::Matrix3Xd tangents_of(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& first,
                             const Eigen::Vector3d& last) {
  const Eigen::Index size = points.cols();
  Eigen::Matrix3Xd tangents(3, size + 1);
  tangents << first,
      (points.rightCols(size - 1) - points.leftCols(size - 1)).colwise().normalized(), last;
  return tangents;
}

}  // namespace

std::optional<double> writhe_modulo_two(const Eigen::Matrix3Xd& tangents,
                                        const Eigen::Vector3d& chord) {
  const Eigen::Vector3d last = tangents.rightCols<1>();
  const auto closing = shortest_rotation(tangents.col(0), last, chord);
  if (!closing) return std::nullopt;
  Eigen::Quaterniond carried = Eigen::Quaterniond::Identity();
  for (Eigen::Index i = 0; i + 1 < tangents.cols(); ++i) {
    carried = Eigen::Quaterniond::FromTwoVectors(tangents.col(i), tangents.col(i + 1)) * carried;
  }
  const Eigen::Quaterniond relative = carried * closing->conjugate();
  return std::atan2(relative.vec().dot(last), relative.w()) / pi;
}

std::optional<Writhe> writhe(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& first,
                             const Eigen::Vector3d& last) {
  const Eigen::Matrix3Xd tangents = tangents_of(points, first, last);
  const auto modulo_two = writhe_modulo_two(
      tangents, (points.rightCols<1>() - points.leftCols<1>()) / length_of(points));
  if (!modulo_two) return std::nullopt;
  const auto graph = writhe_of_graph(tangents);
  return Writhe{*modulo_two,
                nearest_of_class(*modulo_two, graph ? graph : gauss_integral(points, first, last))};
}

std::optional<Writhe> writhe(
    const std::function<Samples(std::span<const double> arc_lengths)>& sample, double begin,
    double end) {
  constexpr int most_points = 2048;
  constexpr int most_crossing_points = 512;
  constexpr double tolerance = 1e-7;
  std::optional<double> coarse;  // writhe modulo two of half as many segments
  Writhe result{0, std::nullopt, 2};
  std::optional<double> crossings;
  bool settled = false;
  for (int points = 64; points <= most_points; points *= 2) {
    std::vector<double> arc_lengths(static_cast<std::size_t>(points) + 1);
    for (int i = 0; i <= points; ++i) {
      arc_lengths[static_cast<std::size_t>(i)] = std::min(begin + (end - begin) * i / points, end);
    }
    const Samples samples = sample(arc_lengths);
    const Eigen::Vector3d first = samples.tangents.leftCols<1>();
    const Eigen::Vector3d last = samples.tangents.rightCols<1>();
    const auto now = writhe_modulo_two(
        samples.tangents,
        (samples.points.rightCols<1>() - samples.points.leftCols<1>()) / (end - begin));
    if (!now) return std::nullopt;
    // The error of great arcs between tangents is of second order, so that Richardson's
    // extrapolation applies.
    const double better = coarse ? *now + std::remainder(*now - *coarse, 2) / 3 : *now;
    result.error = coarse ? std::abs(std::remainder(better - result.modulo_two, 2)) : 2;
    result.modulo_two = better;
    coarse = now;
    if (const auto graph = writhe_of_graph(samples.tangents)) {
      crossings = graph;
      settled = true;
    } else if (!settled && points <= most_crossing_points) {
      const auto before = std::exchange(crossings, gauss_integral(samples.points, first, last));
      settled = before && crossings && std::abs(*before - *crossings) < 0.1;
    }
    if (result.error < tolerance && settled) break;
  }
  result.modulo_two = std::remainder(result.modulo_two, 2);
  result.value = nearest_of_class(result.modulo_two, crossings);
  return result;
}

}  // namespace dlo::energy_model
