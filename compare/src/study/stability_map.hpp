#pragma once

#include <string>
#include <vector>

#include "dlo/compare/progress.hpp"
#include "dlo/compare/scene.hpp"
#include "study/stability.hpp"

namespace dlo::compare {

/// Parameter that is varied in addition to c_F.
enum class MapAxis { c_c, c_h };

/// Axis and resolution of the map.
struct StabilityMapOptions {
  MapAxis axis = MapAxis::c_c;  ///< parameter that is varied in addition to c_F
  int columns = 16;             ///< number of values of c_c or c_h, >= 1
  int rows = 32;                ///< number of values of c_F, >= 2
  /// Steps of each rod, >= 1; the relative error of a limit is about 10 / steps.
  long steps = 20'000;
  int threads = 1;    ///< number of threads at most; 0: as many as the machine has
  Progress progress;  ///< counts blocks of rods; may be empty
};

/// Stability of one rod of the grid.
struct MapPoint {
  double c_c = 0;  ///< stretch stiffness of the segments [N]
  double c_h = 0;  ///< fraction of the last movement that a step adds [-]
  double c_F = 0;  ///< step factor: movement divided by force [m/N]
  /// `pass`: the disturbance grew at most a hundredfold; `oscillates`: it grew more, but to less
  /// than ten lengths; else `diverges`.
  Outcome outcome = Outcome::diverges;
};

/// Limit of c_F for one pair of c_c and c_h.
struct MapColumn {
  double c_c = 0;  ///< stretch stiffness of the segments [N]
  double c_h = 0;  ///< fraction of the last movement that a step adds [-]
  /// Bound of the largest eigenvalue at rest, see force_model::mode_bounds [N/m].
  double fastest_mode = 0;
  /// Largest stable c_F by linear stability, see force_model::largest_step_factor [m/N].
  double predicted = 0;
  double measured = 0;  ///< limit measured by simulation; NaN if the grid does not bracket it [m/N]
  double table_1 = 0;   ///< the paper's own choice of c_F, see table_1_step_share [m/N]
};

/// Measured and predicted limits of c_F.
struct StabilityMap {
  std::string scene;               ///< name of the scene
  MapAxis axis = MapAxis::c_c;     ///< parameter that is varied in addition to c_F
  std::vector<MapColumn> columns;  ///< one per value of that parameter
  std::vector<MapPoint> points;    ///< columns x rows, with growing c_F, column by column
};

/// Computes the largest c_F for which steps dP = c_F F + c_h dP_last, neither limited nor damped,
/// are stable (the condition of the paper's Formula 15), predicted by linear stability and measured
/// by simulation.
///
/// Every rod starts at its rest shape, disturbed by 1e-6 of its length (RMS, the same disturbance
/// for all; in space, or in its plane if its joints have natural angles). Rods are stepped in
/// vectorised batches of eight, on as many threads as allowed. A rod is stable if the disturbance
/// has grown by at most a factor of a hundred at every sample. `measured` is then refined by
/// bisection between the last stable and the first unstable c_F of the grid.
///
/// c_c ranges from EI/L^2, where bending is stiffer than contraction, to AE at c_h = 0; c_h ranges
/// from 0 to 0.99 at the scene's c_c. c_F ranges from a quarter of the smallest predicted limit to
/// four times the largest. Results do not depend on the number of threads.
/// @throws InputError, ConvergenceError if a rest shape is not found, std::invalid_argument if an
/// option is out of range
[[nodiscard]] StabilityMap stability_map(const Scene& scene,
                                         const StabilityMapOptions& options = {});

}  // namespace dlo::compare
