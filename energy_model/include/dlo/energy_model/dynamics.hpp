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

/// A moving rod: its Problem, its masses, the motion of its grips, and its dissipation. Its points
/// obey
///     rho A r'' + c r' + q |v| v = w + N_s,   M_s + t x N = 0,   M = t x (EI t_s + tau EI t_s')
/// (primes: derivatives by time, s: by arc length), |t| = 1, v = r' - (t.r') t. If clamps hold
/// frames or the rod has material directors, M is computed from all elastic strains u (those beyond
/// the natural ones): K (u + tau u'), K = (EI, EI_2, GJ).
struct MovingRod {
  /// Rod, grips, loads and obstacles; loads and weight are constant. The pose of a grip that has a
  /// motion is taken from its motion.
  Problem problem;
  Inertia inertia;  ///< masses, which `problem` does not contain
  /// Motion of each grip; a missing or null entry: the grip does not move.
  std::vector<GripMotion> motions;
  /// Motion that carries the body of each obstacle, whose pose in `problem` is that at the first
  /// time. A missing or null entry: the obstacle does not move.
  std::vector<GripMotion> obstacle_motions;
  double material_damping = 0;  ///< relaxation time tau of Kelvin-Voigt damping [s], >= 0
  double air_drag = 0;  ///< coefficient c of drag, force per length and velocity [N s/m^2], >= 0
  /// Coefficient q of drag across the rod, force per length and squared velocity [N s^2/m^3], >= 0.
  double quadratic_drag = 0;
  std::vector<double> breaks;  ///< times at which a motion is not smooth [s]
};

/// Shape from which the motion begins, as a function that returns samples at arc lengths; only its
/// tangents are used, and its d1 if twist is simulated. Equilibrium::sample is one. The grips have
/// to hold it approximately: it is moved to the positions at which they do.
using StartingShape = std::function<Samples(std::span<const double>)>;

/// Velocities of the rod's points at M arc lengths, 3 x M [m/s].
using StartingVelocities = std::function<Eigen::Matrix3Xd(std::span<const double>)>;

/// Returns the shape of a straight rod along a direction, as the start of a simulation; its points
/// begin at the origin.
/// @throws std::invalid_argument unless the direction has a finite length > 0
[[nodiscard]] StartingShape straight_rod(const Eigen::Vector3d& direction);

/// Energies of a moving rod at one time, and the work and losses up to that time [J].
struct EnergyBalance {
  /// Kinetic energy of the mass and, if the rod has twist, of the small inertia that the simulation
  /// assigns to twist.
  double kinetic = 0;
  double bending = 0;  ///< bending energy int 1/2 EI kappa^2 ds, of strains beyond the natural ones
  double twisting = 0;  ///< twisting energy int 1/2 GJ u3^2 ds, of twist beyond the natural one
  /// Potential of weight and line loads. It is zero at the position that the first clamp along the
  /// rod (without clamps the first grip) has at the first time of the simulation.
  double gravity = 0;
  /// Potential of dead loads, zero at the same position; that of a load on a clamp is zero at the
  /// position of this clamp at the first time.
  double load = 0;
  /// Energy of the springs of yielding obstacles and of the stiff springs that represent rigid
  /// ones.
  double obstacles = 0;
  double dissipated = 0;  ///< energy dissipated in the material and in the air since the first time
  double lost = 0;        ///< energy lost on rigid obstacles since the first time
  double work = 0;        ///< work of grips and of moving obstacles on the rod since the first time

  /// Returns kinetic + bending + twisting + gravity + load + obstacles [J].
  [[nodiscard]] double total() const {
    return kinetic + bending + twisting + gravity + load + obstacles;
  }
};

/// State of a rod at one time.
struct MovingFrame {
  double time = 0;                         ///< [s]
  EnergyBalance energy;                    ///< energies of the whole rod
  std::vector<Reaction> grips;             ///< reactions in the order of Problem::grips
  std::vector<Eigen::Vector3d> obstacles;  ///< force of each obstacle on the rod [N]
  /// Returns samples of the shape at arc lengths within [0, length] [m].
  std::function<Samples(std::span<const double>)> sample;
};

/// Outcome of a simulation.
struct [[nodiscard]] Dynamics {
  /// `converged`: the last requested time is reached with the requested accuracy.
  SolveStatus status = SolveStatus::not_run;
  std::string message = "never ran";  ///< the status in words
  std::vector<MovingFrame> frames;    ///< states at the requested times that were reached
  int terms = 0;                      ///< coefficients of each element and strain component
  /// Number of attempted steps of all spans, in all runs except one in the plane that is repeated
  /// in space. With an adapted step size a step and its two halves count as three.
  long steps = 0;
  /// Size of the smallest step [s].
  double smallest_step = std::numeric_limits<double>::infinity();
  /// Sum over all steps of the change by halving the step: root mean square of the displacement,
  /// weighted by mass, divided by the length. NaN with a fixed step, which is not halved.
  double error_estimate = std::numeric_limits<double>::quiet_NaN();
  /// Largest depth of the rod's axis in a rigid obstacle at the end of a step [m].
  double deepest_contact = 0;
  /// Largest |total - total at the first time + dissipated + lost - work| of all frames, divided by
  /// `largest_energy`; 0 if that is 0.
  double energy_error = std::numeric_limits<double>::infinity();
  /// Largest of the following at the first time and in all frames: kinetic, bending, twisting,
  /// obstacle, dissipated or lost energy, work, and change of gravity and load energy [J].
  double largest_energy = 0;
};

/// Discretisation and accuracy of a simulation.
struct DynamicsOptions {
  /// Coefficients of each element and strain component, 1 to max_terms = 128; converged if more do
  /// not change the result.
  int terms = 12;
  /// Error limit of one step. Two quantities are limited: the root mean square of the displacement
  /// between one step and two steps of half the size, divided by the length; and the error of the
  /// energy balance of the two half steps, divided by the largest energy so far. The two half steps
  /// are kept. Their displacement is more accurate by orders of magnitude.
  double tolerance = 1e-7;
  /// Fixed step size [s]; 0: steps are chosen by the tolerance. A fixed step keeps the method
  /// symmetric in time, so that the energy of an undamped rod does not drift.
  double step = 0;
  /// Largest depth of the rod's axis in a rigid obstacle, divided by the length, > 0. The stiffness
  /// of the obstacles is chosen for this depth. Contact forces last for about this depth divided by
  /// the impact velocity.
  double contact_depth = 1e-3;
  bool spatial = false;  ///< whether a rod whose grips and forces share a plane may leave it
  /// Whether the rod has been in motion before the first time. If so, strains begin with the rates
  /// at which equilibrium shapes would follow the grips and obstacles; else the initial strain
  /// rates are zero.
  bool in_motion = false;
  /// Velocities with which the motion begins, instead of `in_motion`; null: none are given. The rod
  /// starts with the velocities that are compatible with its length and its grips and whose
  /// difference from the given ones has the smallest kinetic energy.
  StartingVelocities velocities;
  double time_limit = std::numeric_limits<double>::infinity();  ///< wall time [s], > 0
};

/// Simulates the motion of an inextensible rod from a shape whose strain rates are zero at first
/// (but see DynamicsOptions::in_motion and velocities); the grips move it. Strains are series of
/// Legendre polynomials, as in solve_energy(). Time integration is collocation at Gauss' four
/// points (order 8); with damping of the material, rigid obstacles or twist it is Radau IIA (order
/// 7). Cross-sections have no inertia: twist, where clamps hold frames or the rod has material
/// directors, is in equilibrium at each time, and Samples::d1 of a frame is then the material
/// director. Rigid obstacles are stiff springs without friction, with the force per length p = k
/// d^2 max(0, 1 + d' / u) at a depth d (Hunt and Crossley 1975). Method, evidence and limits:
/// energy_model/doc/dynamics.md.
/// @param start  shape that the grips hold approximately: it is moved to the positions at which
///               they do
/// @param times  times of the frames [s], growing. The motion begins at 0, or at the first of them
///               if that is negative
/// @throws std::invalid_argument if an argument is out of range; for couples, loads that follow the
/// rod, Problem::drag, axial_stiffness and confined_to_plane; and for grips as far apart as the rod
/// between them is long or farther, a taut_line() included
Dynamics simulate(const MovingRod& rod, const StartingShape& start, std::span<const double> times,
                  const DynamicsOptions& options = {});

}  // namespace dlo::energy_model
