#pragma once

#include <cstddef>
#include <optional>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Index of the first clamp along the rod.
[[nodiscard]] inline std::optional<std::size_t> first_clamp_of(const Scene& scene) {
  std::optional<std::size_t> first;
  for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
    const Gripper& gripper = scene.grippers[i];
    if (gripper.direction && (!first || gripper.at < scene.grippers[*first].at)) first = i;
  }
  return first;
}

}  // namespace dlo::compare
