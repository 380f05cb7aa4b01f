#pragma once

#include <chrono>
#include <cmath>
#include <limits>

#include "dlo/energy_model/interrupt.hpp"

namespace dlo::energy_model {

/// When a solve has to end: at a time, or as soon as its thread is interrupted. Solvers ask between
/// evaluations, so they overrun it by one at most.
class Deadline {
 public:
  /// @param seconds  from now on, > 0; infinity never passes
  explicit Deadline(double seconds = std::numeric_limits<double>::infinity()) : seconds_(seconds) {}

  [[nodiscard]] bool passed() const {
    return interrupted() || (std::isfinite(seconds_) && remaining() <= 0);
  }
  /// [s], below zero once it has passed
  [[nodiscard]] double remaining() const {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin_;
    return seconds_ - spent.count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double seconds_;
};

}  // namespace dlo::energy_model
