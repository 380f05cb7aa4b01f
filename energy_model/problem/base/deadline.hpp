#pragma once

#include <chrono>
#include <cmath>
#include <limits>

#include "dlo/energy_model/interrupt.hpp"

namespace dlo::energy_model {

/// Time limit of a solve, which also ends as soon as its thread is interrupted (Interruption).
/// Solvers check it between evaluations.
class Deadline {
 public:
  /// @param seconds  time limit from now on [s], > 0; infinity never passes
  explicit Deadline(double seconds = std::numeric_limits<double>::infinity()) : seconds_(seconds) {}

  [[nodiscard]] bool passed() const {
    return interrupted() || (std::isfinite(seconds_) && remaining() <= 0);
  }
  /// Returns the remaining time [s], negative after the deadline.
  [[nodiscard]] double remaining() const { return seconds_ - spent(); }
  /// Returns the time since the limit was set [s].
  [[nodiscard]] double spent() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double seconds_;
};

}  // namespace dlo::energy_model
