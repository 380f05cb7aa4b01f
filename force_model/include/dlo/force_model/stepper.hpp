#pragma once

#include "dlo/force_model/instruction_set.hpp"

namespace dlo::force_model {

/// The paper's variants of one simulation step, and ours.
enum class Stepper {
  basic,     ///< dP = c_F F (Formula 7)
  limited,   ///< and no point moves further than l_s (Formulas 16, 17)
  relative,  ///< and no point moves further than l_s against its neighbour (Formula 18)
  dynamic,   ///< `relative`, with a part c_h of the last movement added (Formulas 19, 20)
  automatic  ///< `dynamic` with c_F and c_h chosen from the stiffness of the modes, no damping c_s
};

/// What bounds the movement of one step.
enum class StepLimit { none, absolute, relative };

/// A step as policies; the steppers above are the combinations that the paper tries.
struct StepPolicy {
  StepLimit limit = StepLimit::none;  ///< with l_s
  bool momentum = false;              ///< adds c_h times the last movement
  bool damping = false;               ///< divides by c_s once points oscillate
  bool automatic = false;             ///< overwrites c_F and c_h

  /// Equal in every part.
  bool operator==(const StepPolicy&) const = default;
};

/// The policy of a stepper.
[[nodiscard]] StepPolicy policy(Stepper stepper);

/// Constants of a step. The paper leaves open how c_s grows; what is filled in is said here.
struct StepOptions {
  StepPolicy policy = force_model::policy(Stepper::automatic);  ///< what the step does
  double c_F = 0;  ///< scaling factor [m/N], > 0 unless automatic
  double c_h = 0;  ///< share of the last movement that is kept [-], 0 <= c_h < 1 with momentum
  double l_s = 0;  ///< largest movement [m], > 0 with a limit; 0 and automatic: 1/4 of the shortest
                   ///< rest length
  /// c_s grows by this for each point that turned back in two consecutive steps, and falls by it
  /// after each step without such a point, to no less than 1 [-]. Movements of rounding size do not
  /// count: a rod at rest would seem to oscillate.
  double c_s_change = 0.1;
  /// What the steps run on; any other than the fastest serves tests and measurements only.
  InstructionSet instruction_set = fastest_instruction_set();
};

/// How a step ended.
enum class StepStatus {
  diverged,  ///< a force or movement was not finite; the points were left as they were
  behind,    ///< Simulation::advance only: all good, but fewer steps than were asked for
  good,
};

/// Indicators of one step.
struct StepResult {
  StepStatus status = StepStatus::diverged;  ///< how it ended
  double c_m = 0;                            ///< scaling of this step (Formulas 17, 18, 20) [-]
  double movement = 0;                       ///< d_m: largest movement compared with l_s [m]
  bool limited = false;                      ///< d_m was larger than l_s
};

}  // namespace dlo::force_model
