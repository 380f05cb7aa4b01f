#pragma once

#include <cstddef>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// Depth of a shape within rigid obstacles.
struct Penetration {
  double depth = 0;          ///< largest depth [m]
  std::size_t obstacle = 0;  ///< index in the problem of the obstacle with that depth
};

/// Checks a returned equilibrium for penetration, independently of the search that found it.
/// Measures the depth within rigid obstacles on a grid much finer than the solver's nodes, and
/// changes a successful status to `not_verified` if the depth exceeds `allowed_penetration` rod
/// lengths. Soft obstacles are penetrated in proportion to their force and are not checked.
/// @param[in,out] equilibrium  status, message and penetration
Penetration judge_penetration(const Problem& problem, Equilibrium& equilibrium);

}  // namespace dlo::energy_model
