#include "polygon/self_crossing.hpp"

#include <algorithm>

namespace dlo::compare {
namespace {

/// Along the rod, in diameters: how far apart two places are at least.
constexpr double neighbouring = 3;
/// Over the largest coordinate: axes that cross are this far apart by rounding.
constexpr double rounding = 1e-12;

/// Shares of the way along two segments at which they are nearest (Ericson, Real-Time Collision
/// Detection, 2005, section 5.1.9).
struct Nearest {
  double along_a = 0;
  double along_b = 0;
};

Nearest nearest_of(const Eigen::Vector3d& a, const Eigen::Vector3d& along_a,
                   const Eigen::Vector3d& b, const Eigen::Vector3d& along_b) {
  const auto share = [](double value) { return std::clamp(value, 0.0, 1.0); };
  const Eigen::Vector3d from_b = a - b;
  const double aa = along_a.squaredNorm();
  const double bb = along_b.squaredNorm();
  const double ab = along_a.dot(along_b);
  const double apart_a = along_a.dot(from_b);
  const double apart_b = along_b.dot(from_b);
  const double across = aa * bb - ab * ab;
  Nearest result;
  if (across > 0) result.along_a = share((ab * apart_b - apart_a * bb) / across);
  result.along_b = share((ab * result.along_a + apart_b) / bb);
  result.along_a = share((ab * result.along_b - apart_a) / aa);
  return result;
}

}  // namespace

std::optional<SelfCrossing> self_crossing(const Shape& shape, double diameter) {
  const std::vector<double>& s = shape.arc_length;
  const Eigen::Matrix3Xd& points = shape.points;
  if (points.cols() < 4) return std::nullopt;
  const double close = std::max(diameter, rounding * points.cwiseAbs().maxCoeff());
  std::optional<SelfCrossing> nearest;
  for (Eigen::Index i = 0; i + 3 < points.cols(); ++i) {
    const Eigen::Vector3d along_a = points.col(i + 1) - points.col(i);
    for (Eigen::Index j = i + 2; j + 1 < points.cols(); ++j) {
      const Eigen::Vector3d along_b = points.col(j + 1) - points.col(j);
      const Nearest at = nearest_of(points.col(i), along_a, points.col(j), along_b);
      const auto arc_length = [&](Eigen::Index k, double share) {
        const auto index = static_cast<std::size_t>(k);
        return s[index] + share * (s[index + 1] - s[index]);
      };
      const SelfCrossing here = {
          arc_length(i, at.along_a), arc_length(j, at.along_b),
          (points.col(i) + at.along_a * along_a - points.col(j) - at.along_b * along_b).norm()};
      const bool apart = here.second - here.first >= neighbouring * diameter;
      if (!apart || !(here.distance <= close)) continue;
      if (!nearest || here.distance < nearest->distance) nearest = here;
    }
  }
  return nearest;
}

}  // namespace dlo::compare
