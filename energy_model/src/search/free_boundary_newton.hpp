#pragma once

#include "span/span_solver.hpp"

namespace dlo::energy_model {

/// Moves the ends of a shape's contacts to where the rod lifts off by itself: Newton's method on
/// what is missed there (LiftOff), with differences for derivatives, each an equilibrium of its
/// own, then Broyden's. The shape's energy is stationary in them, so that its error is the square
/// of theirs. Ends that do not settle are left where they came to.
/// @param[in,out] solution  an equilibrium with its contacts
/// @return evaluations of the energy
int free_boundary_newton(SpanSolution& solution, const Deadline& deadline,
                         SpanWorkspace& workspace);

}  // namespace dlo::energy_model
