#pragma once

#include <chrono>

namespace dlo::compare {

/// Wall time since construction.
class Timer {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// A limit of wall time, measured from construction.
class TimeLimit {
 public:
  explicit TimeLimit(double seconds) : seconds_(seconds) {}

  [[nodiscard]] double left() const { return seconds_ - timer_.seconds(); }

 private:
  Timer timer_;
  double seconds_;
};

}  // namespace dlo::compare
