#pragma once

#include <vector>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// The grippers by growing arc length.
[[nodiscard]] std::vector<const Gripper*> grippers_along(const Scene& scene);

/// Distance [m] that every point of the rod keeps from each obstacle. With the rod's length and
/// grips no point gets further than an ellipsoid between two neighbouring grips (foci the grips,
/// the rod between them as its long axis), or a ball around the last. Without stretch.
[[nodiscard]] std::vector<double> obstacle_clearances(const Scene& scene);

/// A scene without the obstacles that its rod cannot reach.
struct ReachedScene {
  Scene scene;                 ///< without them
  std::vector<bool> in_reach;  ///< of each of the original's obstacles
};

/// Those within reach stay, the stretch of the rod included: at most 2 l sqrt(P / EA), P the sum of
/// all loads, since the stretch energy EA d^2 / (2 l) is no more than what the loads do over a way
/// of 2 l. The smaller of EA and c_c.
[[nodiscard]] ReachedScene without_far_obstacles(const Scene& scene);

}  // namespace dlo::compare
