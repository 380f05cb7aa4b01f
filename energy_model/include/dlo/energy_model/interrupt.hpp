#pragma once

namespace dlo::energy_model {

/// A question that every solver of this thread asks between evaluations while this lives: "shall it
/// stop?" Once the answer is yes, solves end as at their time limit, those begun later too, as long
/// as it stays yes. For programs that stop long computations by hand, from whatever called them; a
/// program that knows beforehand how long it will wait sets a time limit.
class Interruption {
 public:
  /// @param asked  must not throw, and be quick: it is called some hundred thousand times a second
  explicit Interruption(bool (*asked)());
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  Interruption(Interruption&&) = delete;
  Interruption& operator=(Interruption&&) = delete;
  /// What was asked before is asked again.
  ~Interruption();

 private:
  bool (*before_)();
};

/// Whether solves of this thread shall stop; no if nobody asks.
[[nodiscard]] bool interrupted();

}  // namespace dlo::energy_model
