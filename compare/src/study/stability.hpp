#pragma once

#include <string>
#include <vector>

#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/progress.hpp"
#include "study/hard_case.hpp"
#include "study/outcome.hpp"

namespace dlo::compare {

/// What dlo stability runs.
struct StabilityOptions {
  /// Steps for the paper's steppers and `verlet`: 10 s of a loop at 20000 steps/s.
  long max_steps = 200'000;
  /// Steps for the steppers `auto` and `implicit`, which say themselves when they are done.
  long max_steps_auto = 20'000'000;
  long steps_at_rest = 10'000'000;  ///< of the case that stays at rest; `implicit`: a hundredth
  double tolerance = 1e-3;          ///< of a pass: largest distance of a point over the length [-]
  int threads = 1;                  ///< at most; 0: as many as the machine has
  /// What to run: cases whose name contains this, with these steppers.
  std::string name_contains;
  std::vector<std::string> excluded;  ///< names of cases that are not run
  /// with which steppers
  std::vector<Stepper> steppers = values<Stepper>();
  Progress progress;  ///< over references and runs; may be empty
};

/// What one stepper makes of one hard case.
struct StabilityResult {
  std::string name;                      ///< of the case
  std::string what;                      ///< what is hard about it
  Stepper stepper = Stepper::automatic;  ///< that ran
  Outcome outcome = Outcome::diverges;   ///< how it ended
  long steps = 0;                        ///< that it took
  /// Largest distance of a point from the reference over the length [-]; NaN if refused, infinite
  /// if not finite.
  double error_over_length = 0;
  bool at_rest = false;  ///< proved by the stepper's own search for rest
  std::string note;      ///< what the numbers do not say; may be empty
};

/// Runs a case with a stepper. c_F = 0.86 L/(2 c_c), l_s = 0.6 L, c_h = 0.9 for the paper's
/// steppers, see step_options, as for `verlet`.
///
/// The reference is the equilibrium that solve_polygon finds for the same parameters from the
/// scene's own start. A simulation that rests elsewhere is held against the equilibrium that
/// solve_polygon finds from the simulation's end; if that is stable and at most the tolerance away,
/// it passes, and the note says so with both energies. The case that stays at rest passes if no
/// look at it finds it further than 1e-6 of its length from where it began; the note says what its
/// energy did, and growth by more than 1e-12 of its size is `wrong`.
/// @throws ConvergenceError if there is no reference
[[nodiscard]] StabilityResult run_hard_case(const HardCase& hard, Stepper stepper,
                                            const StabilityOptions& options = {});

/// Every hard case with every stepper that the options ask for, the steppers of a case one after
/// the other, in the order of hard_cases. Results are the same for any number of threads.
/// @throws InputError if no case's name contains what the options ask for, ConvergenceError
[[nodiscard]] std::vector<StabilityResult> stability(const StabilityOptions& options = {});

}  // namespace dlo::compare
