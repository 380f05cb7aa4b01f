#pragma once

#include <string>
#include <vector>

#include "dlo/compare/progress.hpp"
#include "dlo/compare/scene.hpp"
#include "study/outcome.hpp"

namespace dlo::compare {

/// What varies beside c_F.
enum class MapAxis { c_c, c_h };

/// Which map, and how fine.
struct StabilityMapOptions {
  MapAxis axis = MapAxis::c_c;  ///< what varies beside c_F
  int columns = 16;             ///< values of c_c or c_h, >= 1
  int rows = 32;                ///< values of c_F, >= 2
  long steps = 20'000;  ///< of each rod, >= 1; a limit is found to about 10 / steps of itself
  int threads = 1;      ///< at most; 0: as many as the machine has
  Progress progress;    ///< over blocks of rods; may be empty
};

/// One rod of the grid.
struct MapPoint {
  double c_c = 0;  ///< [N]
  double c_h = 0;  ///< [-]
  double c_F = 0;  ///< [m/N]
  /// `pass`: the disturbance did not grow; `oscillates`: it did, within bounds; else `diverges`.
  Outcome outcome = Outcome::diverges;
};

/// Limit of c_F for one c_c and c_h.
struct MapColumn {
  double c_c = 0;           ///< [N]
  double c_h = 0;           ///< [-]
  double fastest_mode = 0;  ///< bound at rest, see force_model::mode_bounds [N/m]
  double predicted = 0;     ///< largest stable c_F, see force_model::largest_step_factor [m/N]
  double measured = 0;      ///< NaN if the grid has no bracket for it [m/N]
  double table_1 = 0;       ///< the paper's own choice, see table_1_step_share [m/N]
};

/// Measured and predicted limits of c_F.
struct StabilityMap {
  std::string scene;               ///< its name
  MapAxis axis = MapAxis::c_c;     ///< what varies beside c_F
  std::vector<MapColumn> columns;  ///< one per value on the axis
  std::vector<MapPoint> points;    ///< columns x rows, c_F growing, one column after the other
};

/// Where steps dP = c_F F + c_h dP_last, neither limited nor damped, stop being stable (what the
/// paper's Formula 15 asks for), predicted and measured.
///
/// Every rod starts at its rest shape, disturbed in space by 1e-6 of its length (RMS, the same
/// disturbance for all), and is stepped, eight in lockstep, on as many threads as allowed. It is
/// stable if no look at it finds the disturbance a hundredfold. `measured` is then refined by
/// bisection between the last stable and the first unstable c_F of the grid.
///
/// c_c runs from EI/L^2, where bending is stiffer than contraction, to AE at c_h = 0; c_h from 0 to
/// 0.99 at the scene's c_c. c_F runs from a quarter of the smallest predicted limit to four times
/// the largest. Results are the same for any number of threads.
/// @throws InputError, ConvergenceError if a rest shape is not found, std::invalid_argument if an
/// option is out of range
[[nodiscard]] StabilityMap stability_map(const Scene& scene,
                                         const StabilityMapOptions& options = {});

}  // namespace dlo::compare
