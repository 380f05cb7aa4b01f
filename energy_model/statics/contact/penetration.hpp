#pragma once

#include <cstddef>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// How far a shape is behind rigid obstacles.
struct Penetration {
  double depth = 0;          ///< largest depth [m]
  std::size_t obstacle = 0;  ///< index in the problem of the obstacle at which it is that deep
};

/// Judges an equilibrium by what is returned, whatever search has found it: measures how far it is
/// behind rigid obstacles on a grid much finer than the solver's nodes, and takes a success back
/// (`not_verified`) if that is more than `allowed_penetration` lengths. Soft obstacles are entered
/// by as much as they push: nothing to prove.
/// @param[in,out] equilibrium  status, message and penetration
Penetration judge_penetration(const Problem& problem, Equilibrium& equilibrium);

}  // namespace dlo::energy_model
