#pragma once

#include "span/span_solver.hpp"

namespace dlo::energy_model {

/// The free-boundary problem of where a rod lifts off: Newton's method moves the ends of its
/// contacts until the free-boundary residual (FreeBoundary) is zero, with differences for
/// derivatives, each an equilibrium of its own, then Broyden's. The shape's energy is stationary in
/// them, so that its error is the square of theirs. Ends that do not converge are left where they
/// came to.
/// @param[in,out] solution  an equilibrium with its contacts
/// @return evaluations of the energy
int free_boundary_newton(SpanSolution& solution, const Deadline& deadline,
                         SpanWorkspace& workspace);

}  // namespace dlo::energy_model
