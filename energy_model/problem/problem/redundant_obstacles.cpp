#include <algorithm>
#include <utility>
#include <vector>

#include "problem/span.hpp"

namespace dlo::energy_model {
namespace {

/// Distance in span units by which a body may stick out of another one and still count as within
/// it: a hundredth of the allowed depth of a shape behind a rigid obstacle.
constexpr double rounding = 1e-10;
/// Radius, in lengths of the span, within which the core of a body is used. A rod stays within one
/// length of the anchor; the margin is 5 %.
constexpr double beyond_reach = 1.05;

/// Returns the corners of the core of a body, cut to the part that a point near the anchor can
/// reach.
Eigen::Matrix<double, 3, 8> corners_in_reach(const obstacle::Body& body, double reach) {
  const Eigen::Vector3d origin = body.axes().transpose() * -body.centre();
  const auto in_reach = [&](const Eigen::Vector3d& end) {
    return end.cwiseMax((origin.array() - reach).matrix())
        .cwiseMin((origin.array() + reach).matrix())
        .eval();
  };
  const Eigen::Vector3d lower = in_reach(body.lower());
  const Eigen::Vector3d upper = in_reach(body.upper());
  Eigen::Matrix<double, 3, 8> corners;
  for (int i = 0; i < 8; ++i) {
    Eigen::Vector3d local = lower;
    for (int axis = 0; axis < 3; ++axis) {
      if ((i >> axis) % 2 == 1) local[axis] = upper[axis];
    }
    corners.col(i) = body.centre() + body.axes() * local;
  }
  return corners;
}

/// Whether a convex body contains another one, which it does if it contains the balls around the
/// corners of its core.
/// @param beyond  distance by which the other body may stick out, in lengths
bool holds(const obstacle::Body& outer, const Eigen::Matrix<double, 3, 8>& corners, double radius,
           double beyond = rounding) {
  for (Eigen::Index i = 0; i < corners.cols(); ++i) {
    if (!(outer.clearance(corners.col(i)) <= beyond - radius)) return false;
  }
  return true;
}

}  // namespace

void remove_redundant_obstacles(Span& span) {
  std::vector<Span::Obstacle> kept;
  for (const Span::Obstacle& next : span.rigid_obstacles) {
    const double reach = beyond_reach * span.length;
    const Eigen::Matrix<double, 3, 8> corners = corners_in_reach(next.body, reach);
    const bool redundant =
        std::any_of(kept.begin(), kept.end(), [&](const Span::Obstacle& obstacle) {
          return holds(obstacle.body, corners, next.body.radius());
        });
    if (redundant) continue;
    std::erase_if(kept, [&](const Span::Obstacle& obstacle) {
      return holds(next.body, corners_in_reach(obstacle.body, reach), obstacle.body.radius());
    });
    kept.push_back(next);
  }
  span.rigid_obstacles = std::move(kept);
}

bool omit_similar_obstacles(Span& span, std::size_t preferred) {
  // Distance in lengths; also the angle between similar floors [rad].
  constexpr double similar = 1e-3;
  std::vector<Span::Obstacle>& all = span.rigid_obstacles;
  std::stable_partition(all.begin(), all.end(), [&](const Span::Obstacle& obstacle) {
    return obstacle.index == preferred;
  });
  std::vector<Span::Obstacle> kept;
  for (const Span::Obstacle& next : all) {
    const auto corners = corners_in_reach(next.body, beyond_reach * span.length);
    if (std::ranges::none_of(kept, [&](const Span::Obstacle& obstacle) {
          return holds(obstacle.body, corners, next.body.radius(), similar);
        })) {
      kept.push_back(next);
    }
  }
  const bool omitted = kept.size() < all.size();
  all = std::move(kept);
  return omitted;
}

}  // namespace dlo::energy_model
