#pragma once

#include <string>
#include <vector>

#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/progress.hpp"
#include "study/hard_case.hpp"
#include "study/outcome.hpp"

namespace dlo::compare {

/// Settings of dlo stability.
struct StabilityOptions {
  /// Step limit of the paper's steppers and of `verlet`: 10 s of a loop at 20000 steps/s.
  long max_steps = 200'000;
  /// Step limit of the steppers `auto` and `implicit`, which end by themselves when the rod is at
  /// rest.
  long max_steps_auto = 20'000'000;
  /// Steps of the case that starts at rest; `implicit` makes a hundredth of them.
  long steps_at_rest = 10'000'000;
  double tolerance = 1e-3;  ///< of a pass: largest distance of a point, divided by the length [-]
  int threads = 1;          ///< number of threads at most; 0: as many as the machine has
  /// Only cases whose name contains this text are run.
  std::string name_contains;
  std::vector<std::string> excluded;  ///< names of cases that are not run
  /// Steppers that are run.
  std::vector<Stepper> steppers = values<Stepper>();
  Progress progress;  ///< counts references and runs; may be empty
};

/// Result of one stepper on one hard case.
struct StabilityResult {
  std::string name;                      ///< name of the case
  std::string what;                      ///< the difficulty of the case
  Stepper stepper = Stepper::automatic;  ///< stepper of the run
  Outcome outcome = Outcome::diverges;   ///< how the run ended
  long steps = 0;                        ///< number of steps
  /// Largest distance of a point from the reference, or from the other equilibrium that `note`
  /// names, divided by the length [-]; NaN if refused, infinite if not finite.
  double error_over_length = 0;
  bool at_rest = false;  ///< proved by the stepper's own rest criterion
  std::string note;      ///< additional facts, such as another equilibrium; may be empty
};

/// Runs a case with a stepper. The paper's steppers have c_F = 0.86 L/(2 c_c), l_s = 0.6 L and
/// c_h = 0.9, `verlet` its own time step and damping, see step_options.
///
/// The reference is the equilibrium that solve_polygon finds for the same parameters from the
/// scene's own initial guess. A simulation that ends elsewhere without oscillating is compared with
/// the equilibrium that solve_polygon finds from the simulation's final shape. If that equilibrium
/// is stable and at most the tolerance away, the simulation passes, and the note states both
/// energies. The case that starts at rest passes if no sampled shape is farther than 1e-6 of the
/// length from its start; the note states the change of its energy, and growth by more than 1e-12
/// of its magnitude is `wrong`.
/// @throws ConvergenceError if there is no reference
[[nodiscard]] StabilityResult run_hard_case(const HardCase& hard, Stepper stepper,
                                            const StabilityOptions& options = {});

/// Runs every selected hard case with every selected stepper: cases in the order of hard_cases(),
/// for each case the steppers in turn. Results do not depend on the number of threads.
/// @throws InputError if the name of no case contains StabilityOptions::name_contains,
/// ConvergenceError
[[nodiscard]] std::vector<StabilityResult> stability(const StabilityOptions& options = {});

}  // namespace dlo::compare
