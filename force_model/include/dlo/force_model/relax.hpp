#pragma once

#include <string>

namespace dlo::force_model {

/// When a simulation is at rest.
struct RelaxOptions {
  /// Stop when the estimated distance to the rest shape falls below this share of the rod's length
  /// [-], > 0; or below what rounding of stiff segments' forces leaves, if that is more.
  double tolerance = 1e-7;
  long max_steps = 2'000'000;  ///< gives up after so many
};

/// How a search for rest ended.
enum class RelaxStatus { diverged, step_limit, at_rest };

/// In words, for messages.
[[nodiscard]] const char* to_string(RelaxStatus status);

/// Outcome of a simulation that was to come to rest.
struct [[nodiscard]] RelaxResult {
  RelaxStatus status = RelaxStatus::diverged;  ///< how it ended
  std::string message = "never ran";           ///< the same in words
  long steps = 0;                              ///< made by this call
  double residual_force = -1;                  ///< largest force on a free point [N]
  double remaining_error = -1;                 ///< estimated RMS distance of the points to rest [m]
};

}  // namespace dlo::force_model
