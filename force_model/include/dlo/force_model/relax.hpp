#pragma once

#include <limits>
#include <string>

namespace dlo::force_model {

/// Conditions that end Simulation::relax.
struct RelaxOptions {
  /// Tolerance: the simulation is at rest when the RMS distance of the points from the rest shape,
  /// bounded by Newton steps, is below this fraction of the rod's length [-], > 0.
  double tolerance = 1e-7;
  long max_steps = 2'000'000;  ///< number of steps or linear solves after which the search ends
  double time_limit = std::numeric_limits<double>::infinity();  ///< largest elapsed time [s], > 0
  /// Called at intervals of steps; true ends the search as time_limit does.
  bool (*interrupted)() = nullptr;
};

/// Way in which a search for rest ended.
enum class RelaxStatus {
  diverged,    ///< a step was not finite
  step_limit,  ///< RelaxOptions::max_steps
  time_limit,  ///< RelaxOptions::time_limit, or `interrupted` returned true
  at_rest,     ///< proved
  stalled,     ///< implicit steps only: no step lowers the energy, but rest is not proved
};

/// Returns the status in words, for messages.
[[nodiscard]] const char* to_string(RelaxStatus status);

/// Result of a search for rest.
struct [[nodiscard]] RelaxResult {
  RelaxStatus status = RelaxStatus::diverged;  ///< how it ended
  std::string message = "never ran";           ///< the status in words, with any neutral modes
  long steps = 0;  ///< steps of this call; of implicit steps the linear solves
  /// RMS distance of the points from the rest shape [m]: a bound if at rest, else an estimate. If
  /// there is none, as at an unstable shape, it is the remaining momentum, which is 0 for steps
  /// without momentum. -1: never measured.
  double remaining_error = -1;
};

}  // namespace dlo::force_model
