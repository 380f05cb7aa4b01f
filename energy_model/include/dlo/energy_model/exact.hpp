#pragma once

#include <limits>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// Accuracy, limits and initial guess of `exact`.
struct ExactOptions {
  /// Local error of the integrator per step [-], > 0, in angles, positions and moments in units of
  /// l and EI.
  double tolerance = 1e-13;
  /// Time limit of the whole call [s], > 0. A call that reaches it returns `time_limit`, with the
  /// lowest shape found so far if there is one. That shape is an equilibrium, but the search for
  /// others is incomplete.
  double time_limit = std::numeric_limits<double>::infinity();
  /// Shape of this problem or a similar one, with the reactions of its grips, which Newton's method
  /// confirms or corrects without a search. It has to outlive the call. If clamps twist the rod,
  /// the solver starts with the torque of the shape's `twists` and counts whole turns as they do; a
  /// shape without `twists` is treated as the rod without twist. For a rod with material directors,
  /// which must have a clamp, the frames are given by the shape's d1. If it has no d1, which is not
  /// allowed with obstacles, they are computed from the first clamp's frame and the reactions.
  const Equilibrium* start = nullptr;
};

/// Returns the lowest stable equilibrium that shooting finds, of the inextensible rod as a boundary
/// value problem (Kirchhoff's equations; Love, Mathematical Theory of Elasticity, ch. 18-19)
///     r' = t,  R' = R hat(u),  m = R diag(EI_1, EI_2, GJ) (u - u0),  m' = n x t,  n' = -w - f(t),
/// R = (d1, d2, t); m and n are the moment and force that the part beyond s exerts, f is the drag.
/// It uses no basis functions and no code of solve_energy(). energy_model/doc/exact.md describes
/// the search and the contacts that it confirms. It detects no contact: if there are obstacles,
/// ExactOptions::start has to contain the contacts.
///
/// If a load has no potential (has_potential()), that load and all couples are increased from zero,
/// and the result is the equilibrium that continues the lowest one under the other loads. It is
/// `not_verified`, because no energy determines its stability. Its energies do not include such
/// loads.
/// @return the lowest `converged` shape, else the lowest other one, else the reason why there is
/// none. Its stability is that of the second variation by finite elements on its own shape
/// @throws std::invalid_argument if the problem or an option is out of range. Also for weight and
/// loads above 1e6 EI/l^2, for grips as far apart as the rod between them is long unless it
/// stretches or is a taut_line(), for obstacles without a start (unless catenary_limit() applies)
/// or with one whose contacts are not supported, for yielding obstacles, for obstacles together
/// with natural strains, couples, axial_stiffness or a line load that varies along the rod, for
/// axial_stiffness with loads that have no potential, for confined_to_plane, for a clamp without a
/// frame between two that hold frames of a round straight rod, and, if a load has no potential, for
/// obstacles, a load that follows the rod at a clamp, and more than two clamps with frames of a
/// round straight rod. A load that follows along d1 or d2 needs a clamp with a determined d1 and,
/// out of a plane, GJ > 0
Equilibrium solve_exact(const Problem& problem, const ExactOptions& options = {});

/// Returns every equilibrium that the scan or the search finds: `converged` ones first, by energy,
/// then `saddle`, no others. With several spans these are the 64 lowest combinations, and the
/// message states if there are more. Under a load without a potential it is solve_exact()'s alone,
/// `not_verified`. From ExactOptions::start it is the one near the start. Those found until the
/// time limit have the status `time_limit`, and the message describes them. Empty if none was
/// found. For one clamp in the plane the list is complete up to the resolution of the scan
/// (energy_model/doc/exact.md); elsewhere equilibria may be missing.
/// @throws std::invalid_argument as solve_exact()
[[nodiscard]] std::vector<Equilibrium> all_exact(const Problem& problem,
                                                 const ExactOptions& options = {});

}  // namespace dlo::energy_model
