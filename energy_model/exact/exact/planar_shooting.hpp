#pragma once

#include <vector>

#include "base/deadline.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"
#include "problem/reduction.hpp"

namespace dlo::energy_model {

/// Whether shooting from the tip is well posed. The sum of weight and loads over EI/l^2 may be at
/// most 4e5 if they are parallel (beyond, the tip angle against them is below the smallest number),
/// and at most 60 otherwise (beyond, rounding at the tip is amplified too much).
[[nodiscard]] bool planar_shots_are_well_posed(const PlanarCantilever& rod);

/// Result of a scan of the tip's angles.
struct TipShots {
  std::vector<Equilibrium> equilibria;  ///< stable ones first, by energy
  bool complete = true;      ///< false: shots failed, or there were more cells than allowed shots
  bool out_of_time = false;  ///< whether the deadline ended the scan early
  int shots = 0;
};

/// Finds equilibria of a planar rod with one clamp at an end, stable and unstable ones, by shooting
/// from the free end:
///     theta' = kappa,  EI kappa' = n_x sin theta - n_y cos theta,  theta(0) given, kappa(l) = 0,
/// n(s) the sum of weight and loads beyond s. The solution that grows towards the clamp is the one
/// that is integrated, and the angle is measured from the last force. The problem therefore stays
/// well posed if that angle is exponentially small (Gamma >> 1).
///
/// All tip angles are scanned. Each cell of the grid is halved, at most six times, until a cubic
/// from the residual of the clamp's angle and its derivative at both ends has an error below 2 % in
/// the middle. A change of sign of the residual is a root. Two roots are in a cell if the residual
/// approaches zero from both ends and its extremum is beyond zero. If the extremum is below 1e-11,
/// they are one double root.
/// @param tolerance  local error of the integrator per step
[[nodiscard]] TipShots shoot_from_tip(const Problem& problem, const ReducedCantilever& reduced,
                                      double tolerance, const Deadline& deadline);

}  // namespace dlo::energy_model
