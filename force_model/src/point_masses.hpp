#pragma once

#include <vector>

#include "dlo/force_model/rod.hpp"

namespace dlo::force_model {

/// Returns 1 for points that no rigid grip holds, else 0.
[[nodiscard]] std::vector<char> free_points(const Rod& rod);

/// Calls action(grip, k) for each point that a grip holds in this way, the k-th of its grip.
template <typename Action>
void for_each_grip_point(const Rod& rod, GripHold hold, const Action& action) {
  for (const Grip& grip : rod.grips) {
    if (grip.hold != hold) continue;
    for (Eigen::Index k = 0; k < grip.targets.cols(); ++k) action(grip, k);
  }
}

/// Checks the masses of a rod. @throws std::invalid_argument unless there is one per point, > 0 for
/// each free point
void require_masses(const Rod& rod, const std::vector<char>& is_free);

}  // namespace dlo::force_model
