#pragma once

#include "base/deadline.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// Turns the frames of a span's clamps, all together, to where they are held (Problem), from its
/// equilibrium without them on.
///
/// Natural continuation in their roll: Newton's method starts from a secant, or else from the last
/// shape; the steps grow where it takes few shots and are halved where it does not converge or the
/// shape jumps. Where a shape has become unstable, and where the branch ends at a fold, the rod
/// follows the gradient flow of its energy, by backward Euler, to a shape that is stable at that
/// roll.
/// @param span twisted()
/// @param without equilibrium without frames after the first clamp
/// @return not converged, and the roll that was reached in the message, if a step failed
[[nodiscard]] SpanEquilibrium twist_span(const RodSpan& span, const SpanEquilibrium& without,
                                         double tolerance, const Deadline& deadline);

}  // namespace dlo::energy_model
