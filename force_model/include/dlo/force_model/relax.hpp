#pragma once

#include <limits>
#include <string>

namespace dlo::force_model {

/// When a simulation is at rest.
struct RelaxOptions {
  /// Stop when the RMS distance of the points to the rest shape, bounded by Newton's steps, falls
  /// below this share of the rod's length [-], > 0.
  double tolerance = 1e-7;
  long max_steps = 2'000'000;                                   ///< gives up after so many
  double time_limit = std::numeric_limits<double>::infinity();  ///< gives up after so long [s], > 0
  bool (*interrupted)() =
      nullptr;  ///< asked every so many steps; yes ends it as the time limit does
};

/// How a search for rest ended.
enum class RelaxStatus {
  diverged,    ///< a step was not finite
  step_limit,  ///< RelaxOptions::max_steps
  time_limit,  ///< RelaxOptions::time_limit
  at_rest,     ///< proved
  stalled,     ///< implicit steps only: none lowers the energy, nor proves rest
};

/// In words, for messages.
[[nodiscard]] const char* to_string(RelaxStatus status);

/// Outcome of a simulation that was to come to rest.
struct [[nodiscard]] RelaxResult {
  RelaxStatus status = RelaxStatus::diverged;  ///< how it ended
  std::string message = "never ran";           ///< the same in words
  long steps = 0;                              ///< made by this call
  double residual_force = -1;                  ///< largest force on a free point [N]
  double remaining_error = -1;                 ///< RMS distance of the points to rest; a bound if
                                               ///< at rest, else an estimate [m]
};

}  // namespace dlo::force_model
