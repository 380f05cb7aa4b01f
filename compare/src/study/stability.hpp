#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/progress.hpp"
#include "study/hard_case.hpp"

namespace dlo::compare {

/// Classification of a simulation's end.
enum class Outcome {
  pass,        ///< reaches the reference shape and stays there
  wrong,       ///< ends at another shape: at rest without equilibrium, or still creeping
  oscillates,  ///< oscillates instead of coming to rest
  diverges,    ///< not finite, or farther away than the rod could reach
  refused,     ///< ends with an error message instead of a shape
};

/// Names of the outcomes in tables.
template <>
struct Choices<Outcome> {
  /// All outcomes, in the order of the enumeration.
  static constexpr Choice<Outcome> all[] = {{Outcome::pass, "pass", ""},
                                            {Outcome::wrong, "wrong", ""},
                                            {Outcome::oscillates, "oscillates", ""},
                                            {Outcome::diverges, "diverges", ""},
                                            {Outcome::refused, "refused", ""}};
};

/// Data by which the end of a simulation is classified.
struct SimulationEnd {
  bool finite = false;   ///< whether no step has diverged
  bool at_rest = false;  ///< whether rest is proved, see force_model::Simulation::relax
  /// Shapes at equal intervals over the last half of the steps, or over all steps of the case that
  /// starts at rest, the final one last [m], 3 x N each. The final shape alone suffices if it is at
  /// rest.
  std::vector<Eigen::Matrix3Xd> late_shapes;
  std::vector<Eigen::Matrix3Xd> last_shapes;  ///< shapes of the last consecutive steps [m]
};

/// Returns the largest distance of a point from the same point of the reference [m]; infinite if a
/// coordinate is not finite.
[[nodiscard]] double largest_distance(const Eigen::Matrix3Xd& points,
                                      const Eigen::Matrix3Xd& reference);

/// Classifies the end of a simulation by the first case that applies: `diverges` if a step has
/// diverged, there is no late shape, or the final shape is not within ten lengths of the reference;
/// `pass` if the final shape, and each late shape unless the rod is at rest, is within the
/// tolerance; `oscillates` if the rod is not at rest and its late or last shapes oscillate by more
/// than the tolerance; else `wrong`.
/// @param reference  shape to be reached [m], 3 x N
/// @param length     length of the rod [m], > 0;  @param tolerance  divided by the length [-], > 0
[[nodiscard]] Outcome classify(const SimulationEnd& trajectory, const Eigen::Matrix3Xd& reference,
                               double length, double tolerance);

/// Settings of dlo stability.
struct StabilityOptions {
  /// Step limit of the paper's steppers and of `verlet`: 10 s of a loop at 20000 steps/s.
  long max_steps = 200'000;
  /// Step limit of the steppers `auto` and `implicit`, which end by themselves when the rod is at
  /// rest.
  long max_steps_auto = 20'000'000;
  /// Steps of the case that starts at rest; `implicit` makes a hundredth of them.
  long steps_at_rest = 10'000'000;
  /// Largest distance of a point with which a case passes, divided by the length [-].
  double tolerance = 1e-3;
  int threads = 1;  ///< number of threads at most; 0: as many as the machine has
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
  std::string difficulty;                ///< the difficulty of the case
  Stepper stepper = Stepper::automatic;  ///< stepper of the run
  Outcome outcome = Outcome::diverges;   ///< how the run ended
  long steps = 0;                        ///< number of steps
  /// Largest distance of a point from the reference, or from the other equilibrium that `note`
  /// names, divided by the length [-]; NaN if refused, infinite if not finite.
  double error_over_length = 0;
  bool at_rest = false;  ///< whether rest is proved by the stepper's own rest criterion
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
/// @throws InputError if no case is selected by StabilityOptions::name_contains and `excluded`,
/// ConvergenceError
[[nodiscard]] std::vector<StabilityResult> stability(const StabilityOptions& options = {});

}  // namespace dlo::compare
