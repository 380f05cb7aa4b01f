#pragma once

#include <limits>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// How well to integrate, and from where.
struct ExactOptions {
  /// Local error of the integrator per step [-], > 0, of angles, positions and moments in units of
  /// l and EI.
  double tolerance = 1e-13;
  /// Of the whole call [s], > 0; the status is then `time_limit`, with the lowest shape so far if
  /// there is one: it is an equilibrium, but others were not looked for.
  double time_limit = std::numeric_limits<double>::infinity();
  /// A shape to confirm or correct, of this problem or a similar one, with its grips' reactions:
  /// Newton's method starts from it, without a search. Has to outlive the call. Where clamps twist
  /// the rod it starts with the torque of the shape's `twists` and counts whole turns as they do;
  /// without `twists` it is taken for the rod without twist. Of a rod with material directors the
  /// frames are the shape's d1 or, if it has none, follow from the first clamp's, which there has
  /// to be, and from what the grips exert.
  const Equilibrium* start = nullptr;
};

/// Lowest stable equilibrium that shooting finds, of the inextensible rod as a boundary value
/// problem (Kirchhoff's equations; Love, Mathematical Theory of Elasticity, ch. 18-19)
///     r' = t,  R' = R hat(u),  m = R diag(EI_1, EI_2, GJ) (u - u0),  m' = n x t,  n' = -w - f(t),
/// R = (d1, d2, t), m and n what lies beyond s exerts, f the drag; no basis, no code of
/// solve_energy(). energy_model/doc/exact.md describes what it searches and which contacts it
/// confirms. It detects no contact: where there are obstacles, ExactOptions::start has to hold the
/// contacts.
///
/// Where a load has no potential (has_potential()), it is the equilibrium that the lowest one under
/// the others goes over into as that load and all couples grow from nothing; `not_verified`, since
/// no energy says whether it is stable. Its energies are without such loads.
/// @return the lowest `converged` shape, else the lowest other one, else why there is none; its
/// stability is that of the second variation by finite elements on its own shape
/// @throws std::invalid_argument if the problem or an option is out of range; of obstacles any
/// without a start, those that yield, any where a rod has natural strains; of a round straight rod
/// a clamp without a frame between two that hold theirs
Equilibrium solve_exact(const Problem& problem, const ExactOptions& options = {});

/// Every equilibrium that the scan or the search finds, `converged` ones first, by energy, then
/// `saddle`; others are left out. Of several spans the 64 lowest combinations; the message says if
/// there are more. If the time is up, what was found until then: all have the status `time_limit`,
/// and the message says what they are. Empty if nothing was found. One clamp in the plane: all of
/// them up to the scan's resolution (energy_model/doc/exact.md); elsewhere it may miss some.
/// @throws std::invalid_argument as solve_exact()
[[nodiscard]] std::vector<Equilibrium> all_exact(const Problem& problem,
                                                 const ExactOptions& options = {});

}  // namespace dlo::energy_model
