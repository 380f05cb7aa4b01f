#pragma once

#include "base/deadline.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// Rotates the frames of a span's clamps simultaneously to the held ones (Problem), starting from
/// its equilibrium with released frames.
///
/// This is natural continuation in the roll. Newton's method starts from a secant, or else from the
/// last shape. Steps grow if it needs few shots, and are halved if it does not converge or the
/// shape jumps. If a shape has become unstable, and where the branch ends at a fold, the rod
/// follows the gradient flow of its energy, by backward Euler, to a shape that is stable at that
/// roll.
/// @param span     a twisted() span
/// @param without  equilibrium without frames after the first clamp
/// @return not converged if a step failed; the message then states the roll that was reached
[[nodiscard]] SpanEquilibrium twist_span(const RodSpan& span, const SpanEquilibrium& without,
                                         double tolerance, const Deadline& deadline);

}  // namespace dlo::energy_model
