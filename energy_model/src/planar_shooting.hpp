#pragma once

#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"
#include "reduction.hpp"

namespace dlo::energy_model {

/// Whether the shots below are well posed: sum of weight and loads over EI/l^2 up to 4e5 if they
/// are parallel (beyond, the tip's angle against them is below the smallest number), up to 60 if
/// not (beyond, rounding at the tip is magnified too much).
[[nodiscard]] bool planar_shots_are_well_posed(const PlanarCantilever& rod);

/// Every equilibrium of a planar rod with one clamp at an end, lowest energy first, unstable ones
/// included, by shooting from the free end:
///     theta' = kappa,  EI kappa' = n_x sin theta - n_y cos theta,  theta(0) given, kappa(l) = 0,
/// n(s) the sum of weight and loads beyond s. The solution that grows towards the clamp is the one
/// that is wanted, and the angle is that against the last force: so it stays well posed when that
/// angle is exponentially small (Gamma >> 1). All angles of the tip are scanned.
/// @param tolerance  local error of the integrator per step
[[nodiscard]] std::vector<Equilibrium> shoot_from_tip(const Problem& problem,
                                                      const ReducedCantilever& reduced,
                                                      double tolerance);

}  // namespace dlo::energy_model
