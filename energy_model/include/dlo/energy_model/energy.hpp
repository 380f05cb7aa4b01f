#pragma once

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

struct EnergyOptions {
  /// Curvature coefficients K of each smooth piece of the rod; 0 chooses them so that the last ones
  /// have fallen below `tolerance`.
  int terms = 0;
  double tolerance = 1e-10;  ///< of the shape, in units of l; > 0
  int max_evaluations = 2000;
};

/// Minimises bending plus gravity plus load energy of an inextensible Hookean rod,
///     E = int 1/2 EI kappa^2 ds - int w . r ds - sum_j F_j . r(s_j),
/// over the curvature, expanded in orthonormal Legendre polynomials on each piece between loads:
/// kappa = sum a_k p_k, so that bending is |a|^2 / 2 and the Hessian is the identity plus a compact
/// part. NLopt's LD_LBFGS comes near the minimum, Newton steps finish, and their Hessian proves
/// that it is one.
///
/// Planar problems with one clamp at either end. Of several minima it returns the one that turns
/// towards the load by the shorter way, which is the lowest under gravity alone.
/// @throws std::invalid_argument if the problem or an option is out of range
Equilibrium solve_energy(const Problem& problem, const EnergyOptions& options = {});

}  // namespace dlo::energy_model
