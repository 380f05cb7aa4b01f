#pragma once

#include <vector>

#include "base/deadline.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"
#include "problem/reduction.hpp"

namespace dlo::energy_model {

/// Whether the shots below are well posed: sum of weight and loads over EI/l^2 up to 4e5 if they
/// are parallel (beyond, the tip's angle against them is below the smallest number), up to 60 if
/// not (beyond, rounding at the tip is magnified too much).
[[nodiscard]] bool planar_shots_are_well_posed(const PlanarCantilever& rod);

/// What a scan of the tip's angles has found.
struct TipShots {
  std::vector<Equilibrium> equilibria;  ///< stable ones first, by energy
  bool complete = true;      ///< false: shots failed, or there were more cells than can be shot at
  bool out_of_time = false;  ///< the deadline has cut the scan short
  int shots = 0;
};

/// Equilibria of a planar rod with one clamp at an end, stable and unstable ones, by shooting from
/// the free end:
///     theta' = kappa,  EI kappa' = n_x sin theta - n_y cos theta,  theta(0) given, kappa(l) = 0,
/// n(s) the sum of weight and loads beyond s. The solution that grows towards the clamp is the one
/// that is wanted, and the angle is that against the last force: so it stays well posed when that
/// angle is exponentially small (Gamma >> 1).
///
/// All angles of the tip are scanned. Each cell of the grid is halved until a cubic through the
/// residual of the clamp's angle and its derivative at the cell's ends is right to 2 % in its
/// middle, at most six times; then roots are where the residual changes its sign, and in pairs
/// where it comes nearer to zero from both ends of a cell and its extremum lies beyond zero. Pairs
/// that leave less than 1e-11 there are one double root.
/// @param tolerance  local error of the integrator per step
[[nodiscard]] TipShots shoot_from_tip(const Problem& problem, const ReducedCantilever& reduced,
                                      double tolerance, const Deadline& deadline);

}  // namespace dlo::energy_model
