#pragma once

#include <string>

namespace dlo::energy_model {

/// Returns the end of a message about a shape with this number of zero modes; empty if there is
/// none.
[[nodiscard]] inline std::string zero_modes_note(int ways) {
  if (ways == 0) return {};
  return ", " + std::to_string(ways) + (ways == 1 ? " zero mode" : " zero modes");
}

/// End of a message about a shape that couples bend.
inline constexpr const char* in_the_plane =
    "; checked in the plane alone, because a couple has no potential out of it";

}  // namespace dlo::energy_model
