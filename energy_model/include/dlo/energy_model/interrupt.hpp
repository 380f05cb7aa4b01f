#pragma once

namespace dlo::energy_model {

/// Interrupts solvers of this thread. During the lifetime of this object solvers call a function
/// between evaluations, which returns whether to stop. If it returns true, solves end as at their
/// time limit, and so do later solves as long as it returns true. It is meant for programs in which
/// a user stops long computations; a program that knows in advance how long it will wait sets a
/// time limit.
class Interruption {
 public:
  /// @param asked  returns whether to stop. It must not throw and must be fast
  explicit Interruption(bool (*asked)());
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  Interruption(Interruption&&) = delete;
  Interruption& operator=(Interruption&&) = delete;
  /// Restores the function that was in use before.
  ~Interruption();

 private:
  bool (*before_)();
};

/// Whether solves of this thread have to stop; false without an Interruption.
[[nodiscard]] bool interrupted();

}  // namespace dlo::energy_model
