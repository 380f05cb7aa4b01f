#pragma once

#include <array>
#include <cstddef>

namespace dlo::energy_model {

/// Outcome of a solver. A usable shape is `converged` or `roundoff_limited` (succeeded()). The
/// default of every result is `not_run`.
enum class SolveStatus {
  not_run,  ///< the solver was not called
  /// An equilibrium; the second variation of the returned shape is positive, except for zero modes
  /// that the message states.
  converged,
  /// Like `converged`, to the accuracy that double precision allows; the shape is usable.
  roundoff_limited,
  saddle,            ///< an equilibrium, but the second variation has a negative direction
  near_singular,     ///< close to a fold or bifurcation: not determined to the tolerance
  not_verified,      ///< a shape with a claim that is not proven: see the message
  evaluation_limit,  ///< `max_evaluations` of the options; no claim
  time_limit,        ///< `time_limit` of the options, or an interruption (interrupt.hpp)
  failed,            ///< the solver gave up, see the message; no claim
};

/// Whether the shape is usable.
[[nodiscard]] constexpr bool succeeded(SolveStatus status) {
  return status == SolveStatus::converged || status == SolveStatus::roundoff_limited;
}

/// Returns the status in words, for messages.
[[nodiscard]] constexpr const char* to_string(SolveStatus status) {
  constexpr std::array names = {"not run",
                                "converged",
                                "limited by roundoff",
                                "an unstable equilibrium (saddle)",
                                "next to a fold or bifurcation",
                                "not verified",
                                "evaluation limit reached",
                                "time limit reached",
                                "failed"};
  static_assert(names.size() == static_cast<std::size_t>(SolveStatus::failed) + 1);
  return names[static_cast<std::size_t>(status)];
}

}  // namespace dlo::energy_model
