#pragma once

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
  std::vector<OtherState> others;  ///< stable ones first, by energy

  /// No other stable one is as low, as a mirror image is.
  [[nodiscard]] bool only_lowest() const { return rank == 1 && stable == 1; }
};

}  // namespace dlo::compare
