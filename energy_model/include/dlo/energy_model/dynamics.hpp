#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "dlo/energy_model/grip_motion.hpp"
#include "dlo/energy_model/problem.hpp"
#include "dlo/energy_model/status.hpp"
#include "dlo/energy_model/vibrations.hpp"

namespace dlo::energy_model {

/// A rod that moves: what Problem says of it at rest, its masses, what its grips do, and what takes
/// energy from it. Its points obey
///     rho A r'' + c r' + q |v| v = w + N_s,   M_s + t x N = 0,   M = t x (EI t_s + tau EI t_s')
/// (primes: by time, s: by arc length), |t| = 1, v = r' - (t.r') t. Where clamps hold frames or the
/// rod has material directors M is of all strains u beyond the natural ones, K (u + tau u'), K =
/// (EI, EI_2, GJ).
struct MovingRod {
  Problem problem;  ///< loads and weight stay; poses of grips that have a motion are those of it
  Inertia inertia;  ///< what `problem`'s weights do not say
  std::vector<GripMotion> motions;  ///< by grip; empty, or null for one: it stands
  /// By obstacle: what carries its body along, which is where the problem has it at the begin;
  /// empty, or null for one: it stands.
  std::vector<GripMotion> obstacle_motions;
  double material_damping = 0;  ///< tau of Kelvin-Voigt [s], >= 0
  double air_drag = 0;          ///< c, force per length and velocity [N s/m^2], >= 0
  double quadratic_drag = 0;   ///< q, the same across it, by the squared velocity [N s^2/m^3], >= 0
  std::vector<double> breaks;  ///< times at which a motion is not smooth [s]
};

/// The shape that motion begins with: samples at arc lengths, of which the tangents count.
/// Equilibrium::sample is one. Grips have to hold it nearly: it is moved to where they do.
using StartingShape = std::function<Samples(std::span<const double>)>;

/// Velocities of the rod's points at arc lengths [m/s], 3 x their number.
using StartingVelocities = std::function<Eigen::Matrix3Xd(std::span<const double>)>;

/// A straight rod along a direction, to start from.
[[nodiscard]] StartingShape straight_rod(const Eigen::Vector3d& direction);

/// What a moving rod has and has done, up to one time [J].
struct EnergyBalance {
  double kinetic = 0;     ///< of the points' movement
  double bending = 0;     ///< int 1/2 EI kappa^2 ds; of strains beyond the natural ones
  double twisting = 0;    ///< int 1/2 GJ u3^2 ds, the same
  double gravity = 0;     ///< of weight and line loads; zero at the first grip at time 0
  double load = 0;        ///< of dead loads, the same
  double obstacles = 0;   ///< of the springs of what yields, and of those that stand for rigid ones
  double dissipated = 0;  ///< since the begin, in the material and in the air
  double lost = 0;        ///< since the begin, on rigid obstacles
  double work = 0;        ///< since the begin, of grips and of obstacles that move on the rod

  /// kinetic + bending + twisting + gravity + load + obstacles.
  [[nodiscard]] double total() const {
    return kinetic + bending + twisting + gravity + load + obstacles;
  }
};

/// A rod at one time.
struct MovingFrame {
  double time = 0;                         ///< [s]
  EnergyBalance energy;                    ///< of all of the rod
  std::vector<Reaction> grips;             ///< in the order of Problem::grips
  std::vector<Eigen::Vector3d> obstacles;  ///< force of each obstacle on the rod [N]
  /// The shape at arc lengths within [0, length] [m].
  std::function<Samples(std::span<const double>)> sample;
};

/// Outcome of a simulation.
struct [[nodiscard]] Dynamics {
  SolveStatus status = SolveStatus::not_run;  ///< `converged`: to the last time, as asked
  std::string message = "never ran";          ///< the same in words
  std::vector<MovingFrame> frames;            ///< at the times that were asked for and reached
  int terms = 0;                              ///< of each piece and field
  long steps = 0;                             ///< of the integrator, all spans, those repeated too
  double smallest_step = std::numeric_limits<double>::infinity();  ///< [s]
  /// Sum over the steps of what halving a step changed: root mean square of the points'
  /// displacement over the length. NaN with a fixed step, which is not halved.
  double error_estimate = std::numeric_limits<double>::quiet_NaN();
  /// Largest depth of the rod's axis in a rigid obstacle at the end of a step [m].
  double deepest_contact = 0;
  /// Largest |total - total at the begin + dissipated + lost - work| of the frames, over
  /// `largest_energy`.
  double energy_error = std::numeric_limits<double>::infinity();
  /// Of the frames: the largest kinetic, bending, twisting, obstacles', dissipated or lost energy
  /// or work, or change of gravity and load [J].
  double largest_energy = 0;
};

/// How exact a simulation is.
struct DynamicsOptions {
  int terms = 12;  ///< of each piece and field, > 0; converged if more do not change the result
  /// Of one step: root mean square of the displacement by which a step differs from two of half the
  /// size, over the length, and what the energy balance of the two misses, over the largest energy
  /// so far. The two are kept, and their displacement is better by orders of magnitude.
  double tolerance = 1e-7;
  /// [s]; 0: chosen by the tolerance. A fixed one keeps the method symmetric in time, so that an
  /// undamped rod's energy does not drift.
  double step = 0;
  /// Largest depth of the rod's axis in a rigid obstacle, over the length, > 0: obstacles are made
  /// stiff enough for it. Forces of contact are spread over a time that is as this depth over the
  /// speed of what strikes.
  double contact_depth = 1e-3;
  bool spatial = false;  ///< whether a rod whose grips and forces share a plane may leave it
  /// Whether the rod has been in motion before: strains begin with the rates at which shapes in
  /// equilibrium would follow the grips and obstacles. Else they do not change at first.
  bool in_motion = false;
  /// Velocities with which the motion begins, instead of `in_motion`; null: none are given. The rod
  /// starts with velocities that its length and its grips allow: those whose difference from the
  /// given ones has the smallest kinetic energy.
  StartingVelocities velocities;
  double time_limit = std::numeric_limits<double>::infinity();  ///< wall time [s], > 0
};

/// Motion of an inextensible rod from a shape at rest, whose strains do not change
/// at first (but DynamicsOptions::in_motion and velocities): its grips carry it along. Strains in
/// Legendre polynomials, as in solve_energy(); by time collocation at Gauss' four points (order 8),
/// with damping of the material or rigid obstacles, or with twist, Radau's IIA (order 7).
/// Cross-sections have no inertia: twist, where clamps hold frames or the rod has material
/// directors, is in equilibrium at each time. There Samples::d1 of a frame is the material's. Rigid
/// obstacles are stiff ones, p = k d^2 max(0, 1 + d' / u) per length at a depth d (Hunt and
/// Crossley 1975), without friction. Method, evidence and limits: energy_model/doc/dynamics.md.
/// @param start  held by the grips, nearly: it is moved to where they do
/// @param times  to give frames at [s], growing; motion begins at 0, or at the first of them if
/// that is below zero
/// @throws std::invalid_argument if something is out of range
Dynamics simulate(const MovingRod& rod, const StartingShape& start, std::span<const double> times,
                  const DynamicsOptions& options = {});

}  // namespace dlo::energy_model
