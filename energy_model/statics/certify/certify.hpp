#pragma once

#include "strain/span_solution.hpp"

namespace dlo::energy_model {

class NewtonFactors;

/// Looks at what a search returns, at its own x, before it may be called `converged`: the residual
/// of the gradient of E - mu.c and of the constraints, Newton's step from there, and the
/// eigenvalues of the second variation in all directions that the constraints leave, those out of a
/// span's plane included. A negative one makes it a `saddle`; a step that is no small one, or an
/// eigenvalue that is zero to `neutral` in a direction that is no rigid-body mode
/// (rigid_body_modes.hpp), makes it `near_singular`, with the number of such directions. So does a
/// positive one that may change to its double or to zero within what the shape may be off by, as at
/// a fold (Kantorovich's condition). Either way it gets its error. What had failed before stays as
/// it is. The solution's factor tells the second variation where that cannot have changed by a
/// hundredth since; else the solution is left with that of solution.x.
/// @param load  sum of weight and loads, the scale of the residuals
void certify(SpanSolution& solution, double load, NewtonFactors& factors);

/// The same for a plain cantilever that Newton's method has just found, and thereby looked at
/// its step and its second variation in the plane: only that out of the plane is left, and only its
/// sign is told.
void certify_out_of_plane(SpanSolution& solution, double load, NewtonFactors& factors);

}  // namespace dlo::energy_model
