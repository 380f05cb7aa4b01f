#pragma once

#include "strain/span_solution.hpp"

namespace dlo::energy_model {

struct NewtonBuffers;

/// Verifies the result of a search at its own x before it may be `converged`: the residual of the
/// gradient of E - mu.c and of the constraints, Newton's step from there, and the eigenvalues of
/// the second variation in all directions that the constraints leave free. These include directions
/// out of a span's plane, unless Span::stays_in_plane(). A negative eigenvalue makes the result a
/// `saddle`. It becomes `near_singular`, with the number of such directions, if the step is not
/// small, or an eigenvalue is zero to `zero_eigenvalue_limit` in a direction that is no rigid-body
/// mode (rigid_body_modes.hpp). It also becomes `near_singular` if a positive eigenvalue might
/// double or vanish within the error of the shape, as at a fold (Kantorovich's condition). The
/// error is estimated in each case. If the residual is not small, or the grips' forces are too
/// large, the result becomes `failed`. A `near_singular` solution stays so or becomes `failed`;
/// other solutions that are no equilibria stay unchanged. A shape through the middle of a soft
/// obstacle becomes a `saddle`, one very near to it `near_singular` (classify_middle_passage()).
/// Unless the result is `failed`, the solution's factor on return is that at solution.x.
void certify(SpanSolution& solution, NewtonBuffers& buffers);

/// Certifies a plain cantilever that Newton's method has just found, which has checked its step and
/// its second variation in the plane. Only the sign of the second variation out of the plane is
/// determined, unless Span::stays_in_plane(). A singular point, or a shape that may be at a fold,
/// is passed to certify().
void certify_plain_cantilever(SpanSolution& solution, NewtonBuffers& buffers);

}  // namespace dlo::energy_model
