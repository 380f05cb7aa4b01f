#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// How a rod touches an obstacle.
enum class ContactKind {
  lying,     ///< along a part
  touching,  ///< at a point inside the rod
  tip,       ///< at an end of the rod
};

/// In words, for files.
[[nodiscard]] constexpr const char* to_string(ContactKind kind) {
  switch (kind) {
    case ContactKind::lying:
      return "lying";
    case ContactKind::touching:
      return "touching";
    case ContactKind::tip:
      break;
  }
  return "tip";
}

/// Where the rod touches a rigid obstacle.
struct ContactPart {
  std::size_t obstacle = 0;               ///< of Problem::obstacles
  ContactKind kind = ContactKind::lying;  ///< how it touches
  double begin = 0;                       ///< arc length where contact begins [m]
  double end = 0;                         ///< where it ends; `begin` but for `lying` [m]
  Eigen::Vector3d force =
      Eigen::Vector3d::Zero();  ///< of the obstacle on the rod, of all of it [N]
  /// Moment of all of it about the point at `begin` [N m]; zero but for `lying`.
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double begin_force = 0;       ///< what of it is concentrated at the begin of what lies [N]
  double end_force = 0;         ///< and at its end [N]
  double largest_pressure = 0;  ///< per length of what lies, between its ends [N/m]
};

/// Outcome of a solver for a continuous rod: solve_energy() or solve_exact(). Only an equilibrium
/// (`converged`, `roundoff_limited`, `saddle`, `near_singular`) has numbers that mean something;
/// after other ends they are how far the solver came, or defaults, and claim nothing.
struct [[nodiscard]] Equilibrium {
  SolveStatus status = SolveStatus::not_run;  ///< how it ended, what is claimed of the shape
  std::string message = "never ran";          ///< the same in words, zero modes counted
  /// Cost of the call; of a list of equilibria only the first one's counts everything.
  /// `energy`: evaluations of energy and gradient by descents and Newton's method, from all starts,
  /// and of the polygons that detect contact; not Hessians, nor what only checks a shape.
  /// `exact`: integrations of a whole span, or with contact of the whole rod, with or without
  /// derivatives; not its polygons.
  int evaluations = 0;
  int terms = 0;       ///< `energy`: coefficients of each piece and field; 0 for `exact`
  double seconds = 0;  ///< wall time of the call [s]
  /// What is left of the equations [-], the largest of the spans. `energy`: norm of
  /// (g - J^T mu, f c), g by the coefficients in EI/l, c of grips and contact in l and rad, f the
  /// forces' scale 1 + load + |mu| in EI/l^2. `exact`: the largest gap between shots, positions in
  /// l, rotations in rad, moments in f^(1/2) EI/l, forces in f EI/l^2, f of the start; of a rod
  /// shot from its tip the clamp's angle that is missed [rad]; with contact the norm of all over
  /// the largest force. -1: not known, of a part that the time did not suffice for.
  double residual = -1;
  /// `energy`: what points may be away from those of an equilibrium, over the rod's length, by what
  /// the solver, rounding and the terms leave, divided by the eigenvalue nearest to zero (README,
  /// certificate). Up to 2, which is no bound. NaN: not known, always of `exact`.
  double error_estimate = std::numeric_limits<double>::quiet_NaN();
  /// Smallest eigenvalue of the second variation on what the grips leave free, out of a planar
  /// shape's plane too; negative: unstable. `energy`: of the reduced Hessian over EI/l, whose norm
  /// is the bending energy's. `exact`: over int |eta'|^2 + |eta|^2 ds, eta the tangent's change, of
  /// material directors the spin, lengths in l. NaN: not known, as of `exact` with contact, and of
  /// one clamp in a plane, which `energy` proves to be stable without it.
  double smallest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
  /// `energy`, where `near_singular`: eigenvalues that are zero to the tolerance, each a direction
  /// in which a fold or a bifurcation leaves the shape open; 0 where only Newton's step is too
  /// large. Rigid-body modes are not counted: they leave no doubt of the shape. 0 of `exact`.
  int neutral_directions = 0;
  /// `energy`: energies of the stable equilibria that the search found, lowest first and at most
  /// 64, each mirror image of its own [J]. Empty if there was no search, as of a shape that is
  /// followed.
  std::vector<double> stable_energies;
  int passing_starts = 0;  ///< `energy`: starts of the search past obstacles on another side
  /// Largest depth of the axis behind a rigid obstacle, between the solver's own nodes too [m]; 0
  /// without such obstacles. Deeper than `allowed_penetration` lengths, of `exact` a tenth of them,
  /// it is not_verified.
  double penetration = 0;
  Energies energy;                         ///< of the shape, where there is one [J]
  std::vector<Eigen::Vector3d> obstacles;  ///< force of each obstacle on the rod [N]
  std::vector<ContactPart> contacts;       ///< with rigid obstacles, by arc length
  /// In the order of Problem::grips; empty where `exact` has no shape.
  std::vector<Reaction> grips;
  std::vector<TwistedPart> twists;  ///< of what clamps that hold frames twist; by arc length

  /// The shape at M arc lengths within [0, length], in any order [m]; null where `exact` has none.
  /// Throws std::invalid_argument for an arc length that is not on the rod.
  std::function<Samples(std::span<const double>)> sample;
};

}  // namespace dlo::energy_model
