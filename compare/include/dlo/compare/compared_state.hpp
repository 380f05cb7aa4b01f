#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace dlo::compare {

/// An equilibrium of the energy model that was not compared.
struct UncomparedEquilibrium {
  /// Whether its second variation is positive; also true if its stability is not verified or if it
  /// is near singular.
  bool stable = false;
  /// Energy of this equilibrium minus that of the compared one [J].
  double energy_difference_J = 0;
  double rms_from_compared_m = 0;  ///< RMS distance along the rod from the compared equilibrium [m]
  double rms_from_shape_m = 0;     ///< RMS distance from the shape [m]
};

/// The equilibrium that a shape was compared with, and the others of the scene.
struct ComparedEquilibrium {
  double energy_J = 0;          ///< total of Solution::energy
  double rms_from_shape_m = 0;  ///< RMS distance from the shape [m]
  int rank = 1;                 ///< position among the stable ones by energy, 1: the lowest
  int stable = 1;               ///< number of stable equilibria that were found
  int unstable = 0;             ///< number of unstable equilibria that were found
  bool searched = true;         ///< whether other equilibria were searched
  std::vector<UncomparedEquilibrium> others;  ///< stable ones first, by energy

  /// Returns the energy of the compared equilibrium minus that of the lowest known stable one [J];
  /// 0 for the lowest, and for a mirror image whose energy differs by rounding.
  [[nodiscard]] double energy_above_lowest_J() const {
    constexpr double relative_energy_rounding = 1e-9;
    double above = 0;
    for (const UncomparedEquilibrium& other : others) {
      if (other.stable) above = std::max(above, -other.energy_difference_J);
    }
    return above > relative_energy_rounding * std::abs(energy_J) ? above : 0;
  }
};

}  // namespace dlo::compare
