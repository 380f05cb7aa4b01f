#include <algorithm>
#include <optional>
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
constexpr double reachable_radius = 1.05;

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
/// @param reach   distance from the anchor within which the core is used, in lengths
/// @param beyond  distance by which the other body may stick out, in lengths
bool contains_body(const Span::Obstacle& outer, const Span::Obstacle& inner, double reach,
                   double beyond) {
  const Eigen::VectorXd clearances = outer.body.clearances(corners_in_reach(inner.body, reach));
  return clearances.maxCoeff() <= beyond - inner.body.radius();
}

/// Removes the rigid obstacles that another one contains, up to a distance. Of two that contain
/// each other the first stays.
/// @param preferred  index in the problem of an obstacle that stays in any case
void remove_contained(Span& span, double beyond, std::optional<std::size_t> preferred) {
  const double reach = reachable_radius * span.length;
  std::vector<Span::Obstacle> kept;
  for (const Span::Obstacle& next : span.rigid_obstacles) {
    if (std::ranges::any_of(kept, [&](const Span::Obstacle& obstacle) {
          return contains_body(obstacle, next, reach, beyond);
        })) {
      continue;
    }
    std::erase_if(kept, [&](const Span::Obstacle& obstacle) {
      return obstacle.index != preferred && contains_body(next, obstacle, reach, beyond);
    });
    kept.push_back(next);
  }
  span.rigid_obstacles = std::move(kept);
}

}  // namespace

void remove_redundant_obstacles(Span& span) { remove_contained(span, rounding, std::nullopt); }

bool omit_similar_obstacles(Span& span, std::size_t preferred) {
  // Distance in lengths; also the angle between similar floors [rad].
  constexpr double similar_body_tolerance = 1e-3;
  std::vector<Span::Obstacle>& all = span.rigid_obstacles;
  std::stable_partition(all.begin(), all.end(), [&](const Span::Obstacle& obstacle) {
    return obstacle.index == preferred;
  });
  const std::size_t before = all.size();
  remove_contained(span, similar_body_tolerance, preferred);
  return all.size() < before;
}

}  // namespace dlo::energy_model
