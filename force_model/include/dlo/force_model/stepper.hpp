#pragma once

#include <limits>

#include "dlo/force_model/instruction_set.hpp"

namespace dlo::force_model {

/// Variants of one simulation step. `basic` to `dynamic` and the idea of `verlet` are the paper's,
/// `automatic` and `implicit` are dlo's.
enum class Stepper {
  basic,      ///< dP = c_F F (Formula 7)
  limited,    ///< `basic` with damping c_s, and no point moves further than l_s (Formulas 16, 17)
  relative,   ///< as `limited`, but l_s limits movements relative to a neighbour (Formula 18)
  dynamic,    ///< `relative`, with a fraction c_h of the last movement added (Formulas 19, 20)
  automatic,  ///< `dynamic` with c_F and c_h chosen from the stiffness of the modes, no damping c_s
  verlet,     ///< velocities and real masses, see Integration::verlet
  implicit    ///< Newton's step on the tangent stiffness, see Integration::implicit_euler
};

/// Limit of the movement of one step: none, of each point, or of each point relative to its
/// neighbour.
enum class StepLimit { none, absolute, relative };

/// Equation that a step solves. F are the total forces on the points.
enum class Integration {
  /// Movement along F (Formula 7), modified by the other policies.
  along_force,
  /// The paper's alternative (last paragraph of its section II): each point has a velocity v, which
  /// the forces change, and v moves it. It leaves open what divides the force and how the damping
  /// goes; filled in are the points' real masses m (Rod::masses), a damping rate c = damping_rate,
  /// the same for all, and Stoermer's and Verlet's staggered steps of dt = time_step,
  ///     v(t + dt/2) = ((1 - c dt/2) v(t - dt/2) + dt F/m) / (1 + c dt/2),  P += dt v(t + dt/2)
  /// from rest, v(dt/2) = dt F / (2 m): second order in dt. Stable for dt < 2/omega_max, omega_max
  /// the angular frequency of the fastest mode. All of its movement is made: no limit, no c_s.
  verlet,
  /// Implicit Euler with one Newton step (M = diag m, C = c M, K the tangent stiffness):
  ///     (M/dt^2 + C/dt + K) dP = F + M v/dt,   v = dP/dt
  /// first order in dt. With time_step = infinity, the default, there are neither masses nor
  /// velocities: K dP = F, Newton's step to the equilibrium. O(N) by a block-banded Cholesky
  /// factor. Filled in, since K may be indefinite and segments are stiff:
  ///     - a multiple of the identity is added until all pivots are positive and a share of dP is
  ///       accepted;
  ///     - dP turns segments, and lengthens them by its part along them, so that a large turn does
  ///       not stretch them; between two grips the gap that this leaves is spread and lengths are
  ///       restored;
  ///     - which points walls press is part of what is solved (an active set);
  ///     - dP is shortened so that no segment rotates by more than 45 degrees, and then halved
  ///       until the potential energy (with dt that of M and C too) falls by at least a share of
  ///       what the quadratic model promises; while a gripper moves, until that energy is not far
  ///       above the one which the model promises;
  ///     - held points that a gripper has moved since the last step are part of dP; a movement that
  ///       had to be shortened is made in several Newton steps, in the same step. After 64 linear
  ///       solves the held points are set to their targets.
  /// A rod that clamps twist is refused, and so are rods of a Batch.
  implicit_euler,
};

/// Step settings as independent policies; the steppers above are combinations of them.
struct StepPolicy {
  StepLimit limit = StepLimit::none;  ///< movement of a step that is limited to l_s
  bool momentum = false;              ///< whether a step adds c_h times the last movement
  bool damping = false;               ///< whether a step divides by c_s once points oscillate
  bool automatic = false;             ///< whether the policy overwrites c_F and c_h
  /// Values other than along_force ignore the policies above.
  Integration integration = Integration::along_force;

  /// Whether all members are equal.
  bool operator==(const StepPolicy&) const = default;
};

/// Returns the policy of a stepper.
[[nodiscard]] StepPolicy policy(Stepper stepper);

/// Constants of a step. The paper does not state how c_s grows; the assumption is described at
/// c_s_change.
struct StepOptions {
  StepPolicy policy = force_model::policy(Stepper::automatic);  ///< policies of the step
  double c_F = 0;  ///< scaling factor [m/N], > 0 for along_force unless automatic
  double c_h = 0;  ///< fraction of the last movement that is kept [-], 0 <= c_h < 1 with momentum
  double l_s = 0;  ///< largest movement [m], > 0 with a limit; 0 and automatic: 1/4 of the shortest
                   ///< rest length
  /// Change of c_s [-]. c_s grows by this for each point that has reversed its direction in two
  /// consecutive steps. It decreases by this after each step without such a point, but not below
  /// the value 1. Movements of the size of rounding errors do not count, since a rod at rest would
  /// otherwise seem to oscillate.
  double c_s_change = 0.1;
  /// Time step dt in real time [s], > 0, which along_force ignores; infinity: without masses and
  /// time, for implicit_euler, but not for verlet.
  double time_step = std::numeric_limits<double>::infinity();
  double damping_rate = 0;  ///< damping rate c of a step in real time [1/s], >= 0
  /// Instruction set of the steps; sets other than the fastest are for tests and measurements only.
  InstructionSet instruction_set = fastest_instruction_set();
};

/// Way in which a step ended.
enum class StepStatus {
  diverged,  ///< a force or movement was not finite; the points were left unchanged
  behind,    ///< Simulation::advance only: no error, but fewer steps than requested
  good,
};

/// Indicators of one step.
struct StepResult {
  StepStatus status = StepStatus::diverged;  ///< how it ended
  /// Scaling of this step (Formulas 17, 18, 20) [-]; of implicit steps the share of the last dP
  /// that was made, 0 if no share lowers the energy.
  double c_m = 0;
  /// d_m: largest movement before the scaling, which is compared with l_s [m]; of steps by verlet
  /// and implicit_euler the largest movement made.
  double movement = 0;
  /// Whether d_m was larger than l_s or, in an implicit step, the last dP was shortened.
  bool limited = false;
};

}  // namespace dlo::force_model
