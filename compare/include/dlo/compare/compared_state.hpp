#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace dlo::compare {

/// An equilibrium of the energy model beside the one that was compared.
struct OtherState {
  bool stable = false;             ///< its second variation is positive
  double energy_difference_J = 0;  ///< its energy minus that of the one compared
  double rms_from_compared_m = 0;  ///< RMS along the rod from the one compared [m]
  double rms_from_shape_m = 0;     ///< from the shape that was compared
};

/// Which of a scene's equilibria a shape was compared with.
struct ComparedState {
  double energy_J = 0;             ///< Solution::energy, of all
  double rms_from_shape_m = 0;     ///< of it from the shape that was compared
  int rank = 1;                    ///< among the stable ones by energy, 1: the lowest
  int stable = 1;                  ///< how many stable ones were found
  int unstable = 0;                ///< how many unstable ones were found
  bool searched = true;            ///< whether a search looked for other equilibria
  std::vector<OtherState> others;  ///< stable ones first, by energy

  /// Energy of the one compared minus that of the lowest stable one that is known; 0 of the lowest,
  /// and of a mirror image whose energy differs by rounding.
  [[nodiscard]] double energy_above_lowest_J() const {
    constexpr double rounding = 1e-9;
    double above = 0;
    for (const OtherState& other : others) {
      if (other.stable) above = std::max(above, -other.energy_difference_J);
    }
    return above > rounding * std::abs(energy_J) ? above : 0;
  }
  /// No other stable one is as low, as a mirror image is.
  [[nodiscard]] bool only_lowest() const { return rank == 1 && stable == 1; }
};

}  // namespace dlo::compare
