#pragma once

#include "span/span_solver.hpp"

namespace dlo::energy_model {

/// Solves the free-boundary problem of lift-off: moves the ends of a solution's contacts until the
/// free-boundary residual (FreeBoundary) is zero, by Newton's method with finite differences, each
/// of which needs an equilibrium of its own, followed by Broyden updates. The energy is stationary
/// in the ends, so that the error of the shape is the square of theirs. Ends that do not converge
/// stay at their last positions.
/// @param[in,out] solution  an equilibrium with its contacts
/// @return number of energy evaluations
int free_boundary_newton(SpanSolution& solution, const Deadline& deadline,
                         SpanWorkspace& workspace);

}  // namespace dlo::energy_model
