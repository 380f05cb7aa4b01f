#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// Depth behind a rigid obstacle up to which a shape is called converged, in lengths of the rod.
inline constexpr double allowed_penetration = 1e-8;

/// How well to solve, and from where.
struct EnergyOptions {
  /// Curvature coefficients K of each smooth piece of the rod; 0 chooses them so that the last ones
  /// have fallen below `tolerance`.
  int terms = 0;
  double tolerance = 1e-10;     ///< of the shape, in units of l; > 0
  int max_evaluations = 20000;  ///< per descent
  /// Of the whole call [s], > 0; the status is then `time_limit`.
  double time_limit = std::numeric_limits<double>::infinity();
  /// A known equilibrium of a similar problem to start from instead of searching: it is followed,
  /// so that snapping shows where the branch ends. Same length and same clamps.
  const Equilibrium* start = nullptr;
};

/// Minimises bending plus gravity plus load energy of an inextensible Hookean rod,
///     E = int 1/2 EI |t'|^2 ds - int w . r ds - sum_j F_j . r(s_j),
/// over its curvature. Clamps that nothing passes through cut the rod into independent spans; each
/// lies in a plane if its grips and forces do. On each piece between loads, grips and sections, and
/// in the layers at the ends of soft and of taut spans, the curvature in the plane, or in space its
/// two components in a frame that does not rotate about the tangent, is expanded in orthonormal
/// Legendre polynomials, so that bending is |a|^2 / 2 and the Hessian the identity plus a compact
/// part. NLopt's LD_LBFGS (where grips are constraints a trust region, where they stretch the rod
/// springs that become stiffer) comes near the minimum with few terms, Newton steps with all of
/// them finish, and their projected Hessian proves that it is one. Of one clamp Newton's method
/// begins at once, and NLopt is asked where that does not lead down to a minimum.
///
/// Of several minima the lowest that the search finds is returned: one clamp turns towards the load
/// by the shorter way, which is the lowest of all under parallel forces where there is no obstacle,
/// and past the nearest bodies on either side; other spans start from the two of their arches,
/// S-shapes and loops that have the lowest energy and from those that have about as much (from the
/// others where these lead to nothing stable), and what is unstable is followed downhill to the
/// next minimum, also out of its plane.
///
/// Twist (Problem) is put in from the lowest shape without it, in turns of the later clamp, each
/// held against its work; what loses its stability or comes to the end of its branch is followed
/// downhill. Nothing keeps the rod from passing through itself. `start` with its `twists` is gone
/// from directly.
///
/// A rod with material directors (Problem) has the energy of its strains less the natural ones,
///     E = int 1/2 EI_1 (u1 - u01)^2 + 1/2 EI_2 (u2 - u02)^2 + 1/2 GJ (u3 - u03)^2 ds - ...,
/// and strains of all three kinds as unknowns. It lies in a plane if that is across one of its
/// principal axes too; the shape there is proven against leaving it by bending and twisting, as a
/// strip does that is bent about its stiff axis. It is searched from the stress-free shape too, and
/// with its frame turned on.
///
/// What touches a rigid obstacle, and where, is first told by a polygon at rest (solve_polygon)
/// from several starts. Then the rod's own shape is found with these contacts: pieces end where
/// contact does. A contact at one point slides, as the least clearance near it; a part that lies
/// has its slope's moments as constraints, whose multipliers are the force that the obstacle
/// carries, and ends at arc lengths that are unknowns, found by Newton's method from what a
/// frictionless obstacle demands there (no bending towards it but its own curvature). Contacts that
/// would have to pull go, others come where the shape is behind an obstacle, a bounded number of
/// times. `converged` says of contact that no point of the rod is deeper than `allowed_penetration`
/// (Equilibrium::penetration) and that no obstacle pulls; what does not converge is `not_verified`.
/// Between clamps that twist the rod contacts are updated at each step of the rotation. A lying rod
/// against its exact solution is right to 1e-12 l. Obstacles that yield are springs along the rod,
/// and their energy is part of E. Where contact with them begins and ends the force per length has
/// kinks: pieces end there, at ends that are found with the shape. What passes through the axis of
/// such an obstacle is no stable equilibrium.
/// @throws std::invalid_argument if the problem or an option is out of range, with the numbers
Equilibrium solve_energy(const Problem& problem, const EnergyOptions& options = {});

/// A kind of start that a search for all equilibria has looked from.
struct SearchStrategy {
  std::string name;     ///< in words: the start, and how it is left
  int tried = 0;        ///< starts
  int found_first = 0;  ///< equilibria that no start before had led to
};

/// What a search for all equilibria has found, from where, and what it may have missed. A search
/// proves nothing of what it has not found.
struct EnergySearch {
  /// Stable ones first, by energy; unstable ones have the status `saddle`, those at a fold or
  /// bifurcation `near_singular`. Never empty.
  std::vector<Equilibrium> equilibria;
  /// In the order of their first use. Spans count each on their own; their equilibria are combined
  /// to those of the rod.
  std::vector<SearchStrategy> looked_from;
  std::vector<std::string> not_looked;  ///< what was cut short or left out, and why; in words
};

/// Every equilibrium that the search's starts lead to, and what these were.
[[nodiscard]] EnergySearch search_energy(const Problem& problem, const EnergyOptions& options = {});

/// Its equilibria alone.
[[nodiscard]] std::vector<Equilibrium> all_energy(const Problem& problem,
                                                  const EnergyOptions& options = {});

/// The same with buffers that survive a solve, for loops. One thread at a time.
class EnergySolver {
 public:
  /// @throws std::invalid_argument if an option is out of range
  explicit EnergySolver(const EnergyOptions& options = {});
  ~EnergySolver();
  /// Takes the buffers over.
  EnergySolver(EnergySolver&& other) noexcept;
  EnergySolver& operator=(EnergySolver&& other) noexcept;  ///< Takes the buffers over.
  EnergySolver(const EnergySolver& other) = delete;
  EnergySolver& operator=(const EnergySolver& other) = delete;

  /// solve_energy().
  Equilibrium solve(const Problem& problem);
  /// From the shape of the last call instead of a search, if it had one: for a gripper or an
  /// obstacle that has moved a little. By Newton's method with the contacts that it has, which are
  /// mended as they change; where that leads to no equilibrium near the last shape, or to one that
  /// gives way, the branch has ended, and the shape is the next minimum downhill of the last, or
  /// failing that what solve() finds. The problem has the same obstacles in the same order.
  Equilibrium follow(const Problem& problem);
  /// follow() as far as Newton's method stays on the branch, without what it does beyond. None
  /// where that leads to no stable equilibrium near the last shape, or there is none: the next call
  /// then goes on from the same shape as this one, in a smaller step for instance.
  std::optional<Equilibrium> keep(const Problem& problem);
  /// Forgets the shape of the last follow() or keep() that had one: the next call goes on from the
  /// shape before it. Once for each of them.
  void go_back();
  /// Whether the last follow() has stayed on its branch, as far as Newton's method tells: the shape
  /// is next to the one before. Work and energy tell too (a snap-through releases energy).
  [[nodiscard]] bool followed() const;
  /// search_energy().
  [[nodiscard]] EnergySearch search(const Problem& problem);
  /// all_energy().
  [[nodiscard]] std::vector<Equilibrium> solve_all(const Problem& problem);

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace dlo::energy_model
