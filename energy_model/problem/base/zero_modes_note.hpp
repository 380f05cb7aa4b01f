#pragma once

#include <string>

namespace dlo::energy_model {

/// How a message goes on about a shape that can move in so many ways without a change of energy;
/// empty where there is none.
[[nodiscard]] inline std::string zero_modes_note(int ways) {
  if (ways == 0) return {};
  return ", " + std::to_string(ways) + (ways == 1 ? " zero mode" : " zero modes");
}

/// How a message goes on about a shape that couples bend.
inline constexpr const char* in_the_plane =
    "; in the plane alone: out of it a couple has no potential";

}  // namespace dlo::energy_model
