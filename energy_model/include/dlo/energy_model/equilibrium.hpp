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
  double begin_force = 0;       ///< what of it is concentrated at the begin of what lies [N]
  double end_force = 0;         ///< and at its end [N]
  double largest_pressure = 0;  ///< per length of what lies, between them [N/m]
};

/// Outcome of a solver for a continuous rod.
struct [[nodiscard]] Equilibrium {
  SolveStatus status = SolveStatus::not_run;  ///< how it ended
  std::string message = "never ran";          ///< the same in words
  int evaluations = 0;  ///< of the objective, with or without derivatives; shots for `exact`
  int terms = 0;        ///< curvature coefficients; 0 for `exact`
  double seconds = 0;   ///< wall time of the solver
  /// Norm of the gradient over EI/l; for `exact` the largest gap that a shot leaves [-].
  double residual = -1;
  /// Of solve_energy(): what points of the shape may be away from those of an equilibrium, over the
  /// rod's length: an estimate from what the solver, rounding and truncation leave, divided by
  /// the eigenvalue nearest to zero. `near_singular` shapes have one too. NaN: not known
  /// (obstacles, `exact`).
  double error_estimate = std::numeric_limits<double>::quiet_NaN();
  /// Smallest eigenvalue of the reduced Hessian (the second variation on what the constraints leave
  /// free) over EI/l, for planar shapes with bending out of the plane; NaN where a solver did not
  /// look. Negative: unstable.
  double smallest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
  /// Of solve_energy(), where `near_singular`: eigenvalues of the second variation that are zero to
  /// the tolerance, each a direction in which a fold or a bifurcation leaves the shape open. 0
  /// where only the step is too large. Rigid-body modes, as of a rod held by pins on a line along
  /// its load, are not counted: they leave no doubt of its shape, and it is converged.
  int neutral_directions = 0;
  /// Largest depth of the shape behind a rigid obstacle, between the solver's own nodes too [m]; 0
  /// without such obstacles. A shape that is deeper than `allowed_penetration` lengths is
  /// not_verified.
  double penetration = 0;
  Energies energy;                         ///< of the shape [J]
  std::vector<Eigen::Vector3d> obstacles;  ///< force of each obstacle on the rod [N]
  std::vector<ContactPart> contacts;       ///< with rigid obstacles, by arc length
  std::vector<Reaction> grips;             ///< in the order of Problem::grips
  std::vector<TwistedPart> twists;         ///< of what clamps that hold frames twist; by arc length

  /// The shape at arc lengths within [0, length], in any order [m].
  std::function<Samples(std::span<const double>)> sample;
};

}  // namespace dlo::energy_model
