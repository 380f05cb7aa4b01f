#pragma once

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

struct ExactOptions {
  double tolerance = 1e-13;  ///< local error of the integrator per step, > 0
};

/// The elastica as a boundary value problem, by GSL and without any basis or minimiser:
///     theta' = kappa,  EI kappa' = n_x sin theta - n_y cos theta,  theta(0) given, kappa(l) = 0,
/// n(s) the sum of weight and loads beyond s. It is shot from the free end, where the solution that
/// grows towards the clamp is the one that is wanted, in the angle against the last force: so it
/// stays well posed when that angle is exponentially small (Gamma >> 1). All starts are scanned;
/// the equilibrium of lowest energy is returned.
///
/// Planar problems with one clamp at either end; sum of weight and loads over EI/l^2 up to 4e5 if
/// they are parallel, up to 60 if not.
/// @throws std::invalid_argument if the problem or an option is out of range
Equilibrium solve_exact(const Problem& problem, const ExactOptions& options = {});

/// Every equilibrium that the scan finds, lowest energy first, unstable ones included.
[[nodiscard]] std::vector<Equilibrium> all_exact(const Problem& problem,
                                                 const ExactOptions& options = {});

/// Gamma = w l^3 / (EI) at which an upright rod buckles under its own weight: z^3 with z the first
/// root of sqrt(3) Ai(-z) + Bi(-z).
[[nodiscard]] double self_buckling_gamma();

}  // namespace dlo::energy_model
