#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// Kind of contact between a rod and an obstacle.
enum class ContactKind {
  lying,     ///< contact along a part of the rod
  touching,  ///< contact at a point inside the rod
  tip,       ///< contact at an end of the rod
};

/// Returns the name of a contact kind, as files contain it.
[[nodiscard]] constexpr const char* to_string(ContactKind kind) {
  constexpr std::array names = {"lying", "touching", "tip"};
  return names[static_cast<std::size_t>(kind)];
}

/// One contact of the rod with a rigid obstacle.
struct ContactPart {
  std::size_t obstacle = 0;               ///< index in Problem::obstacles
  ContactKind kind = ContactKind::lying;  ///< kind of the contact
  double begin = 0;                       ///< arc length where contact begins [m]
  /// Arc length where contact ends [m]; equal to `begin` unless the kind is `lying`.
  double end = 0;
  /// Resultant force of the obstacle on the rod [N].
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  /// Moment of all forces of this contact about the point at `begin` [N m]; zero unless the kind is
  /// `lying`.
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  /// Part of the force that is concentrated at `begin`, if the rod lies [N].
  double begin_force = 0;
  double end_force = 0;  ///< part of the force that is concentrated at `end`, if the rod lies [N]
  /// Largest force per length between the ends, if the rod lies [N/m].
  double largest_pressure = 0;
};

/// Outcome of a solver for a continuous rod: solve_energy() or solve_exact(). The numbers are
/// meaningful only for an equilibrium (`converged`, `roundoff_limited`, `saddle`, `near_singular`).
/// With another status they are those of the last iterate, or defaults, and claim no more than the
/// message.
struct [[nodiscard]] Equilibrium {
  SolveStatus status = SolveStatus::not_run;  ///< outcome, and the claim on the shape
  std::string message = "never ran";  ///< the status in words, with the number of zero modes
  /// Cost of the call; in a list of equilibria usually only the first one counts the whole cost.
  /// `energy`: evaluations of energy and gradient by descents and Newton's method from all initial
  /// guesses, and of the polygons that detect contact. Hessians do not count; of the
  /// evaluations of a certificate at most one counts.
  /// `exact`: integrations of a whole span, or of the whole rod if there is contact, with or
  /// without derivatives. Its polygons do not count.
  int evaluations = 0;
  int terms = 0;  ///< `energy`: coefficients of each element and strain component; 0 for `exact`
  double seconds = 0;  ///< wall time of the call [s]; 0 for a shape of shape_without_search()
  /// Residual of the equations [-], the largest of all spans. It is 0 for taut_line();
  /// catenary_limit() describes its own.
  /// `energy`: norm of (g - J^T mu, f c), with the gradient g by the coefficients in EI/l, the
  /// constraints c of grips and contact in l and rad, and the scale of the forces f = 1 + load +
  /// |mu| in EI/l^2.
  /// `exact`: the largest gap between shots, with positions in l, rotations in rad, moments in
  /// f^(1/2) EI/l and forces in f EI/l^2, f from the initial guess. For a rod that is shot from its
  /// tip it is the error of the clamp's angle [rad]. -1: unknown, for a span for which the time did
  /// not suffice.
  double residual = -1;
  /// `energy`: estimated distance of the points from those of an equilibrium, divided by the rod
  /// length: the remaining error of solver, rounding and truncation, divided by the eigenvalue
  /// nearest zero (README, certificate). At most 2, which is no bound. NaN: unknown, for `exact`
  /// always except for a shape of shape_without_search().
  double error_estimate = std::numeric_limits<double>::quiet_NaN();
  /// Smallest eigenvalue of the second variation in the directions that the grips leave free, out
  /// of the plane of a planar shape too unless couples act or the rod is confined_to_plane;
  /// negative: unstable. `energy`: eigenvalue of the reduced Hessian over EI/l, in the norm of the
  /// bending energy. `exact`: relative to int |eta'|^2 + |eta|^2 ds, where eta is the change of the
  /// tangent (with material directors: the spin) and lengths are in l. NaN: unknown. It is unknown
  /// for a shape of shape_without_search(), and for `exact` if the loads have no potential. It may
  /// be unknown for `energy` if the rod has a free end whose part from the nearest grip, a clamp,
  /// is uniform, straight and round and lies in a plane under parallel forces, because the
  /// stability of such a part is proven without it.
  double smallest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
  /// `energy`, if `near_singular`: number of eigenvalues that are zero to the tolerance. Each is a
  /// direction in which a fold or a bifurcation leaves the shape undetermined. At least 1 if an
  /// eigenvalue may vanish within the error, or if the rod passes very near to a yielding
  /// obstacle's middle. It is 0 if only the Newton step is too large. Rigid-body modes do not
  /// count, because they leave no doubt about the shape. Always 0 for `exact`.
  int neutral_directions = 0;
  /// `energy`: energies of the stable equilibria that the search found, lowest first, at most 64;
  /// each mirror image has an entry of its own [J]. Empty if the call was given a known shape
  /// (EnergyOptions::start, follow(), near()) or needed no search.
  std::vector<double> stable_energies;
  /// `energy`: number of initial guesses that pass obstacles on another side; 0 from a known shape.
  int other_side_starts = 0;
  /// Largest depth of the axis behind a rigid obstacle, between the solver's nodes too [m]; 0
  /// without such obstacles. Beyond `allowed_penetration` lengths a stable shape of `energy` is
  /// not_verified, beyond a tenth of that any equilibrium of `exact`.
  double penetration = 0;
  Energies energy;                         ///< energies of the shape, if there is one [J]
  std::vector<Eigen::Vector3d> obstacles;  ///< force of each obstacle on the rod [N]
  std::vector<ContactPart> contacts;       ///< contacts with rigid obstacles, by arc length
  /// Reactions in the order of Problem::grips; empty if `exact` has no shape.
  std::vector<Reaction> grips;
  /// Twist of the parts between clamps that hold frames, by arc length.
  std::vector<TwistedPart> twists;

  /// Returns the shape at M arc lengths within [0, length], in any order [m]; null if `exact` has
  /// none. Throws std::invalid_argument for an arc length that is not on the rod.
  std::function<Samples(std::span<const double>)> sample;
};

}  // namespace dlo::energy_model
