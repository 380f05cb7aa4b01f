#include "polygon/self_crossing.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "shape/curve.hpp"

namespace dlo::compare {
namespace {

/// Smallest distance along the rod between two points that can cross, in diameters.
constexpr double least_crossing_distance = 3;
/// Rounding of a distance, divided by the largest coordinate: axes that cross may be this far
/// apart.
constexpr double coordinate_rounding = 1e-12;

/// Returns the arc length at a fraction of a segment.
double arc_length_on(const Shape& shape, Eigen::Index segment, double share) {
  const auto k = static_cast<std::size_t>(segment);
  return shape.arc_length[k] + share * (shape.arc_length[k + 1] - shape.arc_length[k]);
}

/// Returns the nearest points of two segments (Ericson, Real-Time Collision Detection, 2005,
/// section 5.1.9).
SelfCrossing crossing_of(const Shape& shape, Eigen::Index i, Eigen::Index j) {
  const auto share = [](double value) { return std::clamp(value, 0.0, 1.0); };
  const Eigen::Vector3d a = shape.points.col(i);
  const Eigen::Vector3d b = shape.points.col(j);
  const Eigen::Vector3d along_a = shape.points.col(i + 1) - a;
  const Eigen::Vector3d along_b = shape.points.col(j + 1) - b;
  const Eigen::Vector3d from_b = a - b;
  const double aa = along_a.squaredNorm();
  const double bb = along_b.squaredNorm();
  const double ab = along_a.dot(along_b);
  const double apart_a = along_a.dot(from_b);
  const double apart_b = along_b.dot(from_b);
  const double across = aa * bb - ab * ab;
  double at_a = across > 0 ? share((ab * apart_b - apart_a * bb) / across) : 0;
  const double at_b = share((ab * at_a + apart_b) / bb);
  at_a = share((ab * at_b - apart_a) / aa);
  return {arc_length_on(shape, i, at_a), arc_length_on(shape, j, at_b),
          (a + at_a * along_a - b - at_b * along_b).norm()};
}

}  // namespace

std::optional<SelfCrossing> self_crossing(const Shape& shape, double diameter) {
  const Eigen::Index segments = shape.points.cols() - 1;
  if (segments < 3) return std::nullopt;
  const Eigen::VectorXd h = chord_lengths(shape.points);
  const double longest = h.maxCoeff();
  const double least_separation =
      least_crossing_distance * diameter;  // least distance along the rod [m]
  const std::vector<double>& s = shape.arc_length;
  const double slack = coordinate_rounding * shape.points.cwiseAbs().maxCoeff();
  double near = std::max(diameter, slack);
  std::vector<double> along = {h[0] / 2};  // length of the polygon up to the middle of each segment
  for (Eigen::Index i = 1; i < segments; ++i) along.push_back(along.back() + (h[i - 1] + h[i]) / 2);
  const auto middle = [&](Eigen::Index i) -> Eigen::Vector3d {
    return (shape.points.col(i) + shape.points.col(i + 1)) / 2;
  };
  std::optional<SelfCrossing> found;
  for (Eigen::Index i = 0; i < segments; ++i) {
    // All segments before this one are too close along the rod.
    const Eigen::Index far = std::lower_bound(s.begin() + i, s.end(),
                                              s[static_cast<std::size_t>(i)] + least_separation) -
                             s.begin() - 2;
    for (Eigen::Index j = std::max(i + 2, far); j < segments;) {
      // The distance of the middles changes by no more than the polygon's length between them, so
      // the next segments cannot be nearer to this one than the nearest pair so far.
      const double least = (middle(i) - middle(j)).norm() - (h[i] + longest) / 2 - near - slack;
      const auto next = std::upper_bound(along.begin() + j + 1, along.end(),
                                         along[static_cast<std::size_t>(j)] + least);
      if (!(least > 0)) {
        const SelfCrossing here = crossing_of(shape, i, j);
        // If several pairs have the same distance, the first along the rod counts.
        const bool is_nearer = found ? here.distance < near : here.distance <= near;
        if (is_nearer && here.second - here.first >= least_separation) {
          found = here;
          near = here.distance;
        }
      }
      j = next - along.begin();
    }
  }
  return found;
}

}  // namespace dlo::compare
