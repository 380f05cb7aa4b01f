#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "dlo/energy_model/turns.hpp"

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

/// Gauss's integral over two segments, ab and cd: the solid angle of the directions in which they
/// are seen to cross [rad].
double crossing_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                      const Eigen::Vector3d& d) {
  const Eigen::Vector3d ac = c - a;
  const Eigen::Vector3d ad = d - a;
  const Eigen::Vector3d bc = c - b;
  const Eigen::Vector3d bd = d - b;
  std::array<Eigen::Vector3d, 4> normals = {ac.cross(ad), ad.cross(bd), bd.cross(bc), bc.cross(ac)};
  for (Eigen::Vector3d& normal : normals) {
    const double size = normal.norm();
    if (size == 0) return 0;  // in one plane
    normal /= size;
  }
  double angle = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    angle += std::asin(std::clamp(normals[k].dot(normals[(k + 1) % 4]), -1.0, 1.0));
  }
  const double side = (d - c).cross(b - a).dot(ac);
  return side == 0 ? 0 : std::copysign(angle, side);
}

/// Whether the half-line from `from` passes the segment ab at less than `distance`.
bool passes(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, const Eigen::Vector3d& a,
            const Eigen::Vector3d& b, double distance) {
  const auto across = [&](const Eigen::Vector3d& v) -> Eigen::Vector3d {
    return v - v.dot(direction) * direction;
  };
  const Eigen::Vector3d to_a = across(a - from);
  const Eigen::Vector3d side = across(b - a);
  const double squared = side.squaredNorm();
  const double t = squared > 0 ? std::clamp(-to_a.dot(side) / squared, 0.0, 1.0) : 0.0;
  const double along = (a + t * (b - a) - from).dot(direction);
  return along > distance && (to_a + t * side).norm() < distance;
}

/// The area, signed, of the triangle of three unit vectors on the sphere [rad].
double spherical_area(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                      const Eigen::Vector3d& c) {
  return 2 * std::atan2(a.dot(b.cross(c)), 1 + a.dot(b) + b.dot(c) + c.dot(a));
}

/// Fuller's area over 2 pi, between the tangents and the great circle that joins the end ones. It
/// is the writhe where all are on one side of the sphere, about the middle of these. None: they are
/// not.
std::optional<double> writhe_of_graph(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& first,
                                      const Eigen::Vector3d& last) {
  constexpr double least = 1e-3;  // of a tangent along the middle
  const Eigen::Vector3d middle = (first + last).normalized();
  if (!(middle.dot(first) > least)) return std::nullopt;
  double area = 0;
  Eigen::Vector3d before = first;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const bool at_end = i + 1 == points.cols();
    const Eigen::Vector3d tangent =
        at_end ? last : Eigen::Vector3d((points.col(i + 1) - points.col(i)).normalized());
    if (!(middle.dot(tangent) > least)) return std::nullopt;
    area += spherical_area(middle, before, tangent);
    before = tangent;
  }
  return area / (2 * pi);
}

}  // namespace

std::optional<double> writhe(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& first,
                             const Eigen::Vector3d& last) {
  if (const std::optional<double> graph = writhe_of_graph(points, first, last)) return graph;
  const Eigen::Index size = points.cols();
  const double length =
      (points.rightCols(size - 1) - points.leftCols(size - 1)).colwise().norm().sum();
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

std::optional<double> writhe(
    const std::function<Samples(std::span<const double> arc_lengths)>& sample, double begin,
    double end) {
  constexpr int first_points = 64;
  constexpr int most_points = 1024;
  constexpr double tolerance = 1e-2;
  std::optional<double> before;
  for (int points = first_points; points <= most_points; points *= 2) {
    std::vector<double> arc_lengths(static_cast<std::size_t>(points));
    for (int i = 0; i < points; ++i) {
      arc_lengths[static_cast<std::size_t>(i)] =
          std::min(begin + (end - begin) * i / (points - 1), end);
    }
    const Samples samples = sample(arc_lengths);
    const std::optional<double> now =
        writhe(samples.points, samples.tangents.col(0), samples.tangents.col(points - 1));
    if (!now || (before && std::abs(*now - *before) < tolerance)) return now;
    before = now;
  }
  return std::nullopt;
}

}  // namespace dlo::energy_model
