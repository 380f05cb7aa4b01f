#pragma once

#include "base/deadline.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// Follows an equilibrium while loads without a potential grow from zero (loaded_by()). The
/// continuation uses a secant predictor. A step is halved if Newton's method does not
/// converge, or rotates a tangent by more than half a radian from the prediction. It does not pass
/// a fold: the result is then not converged, and the message states the share of the loads that was
/// reached.
/// @param unloaded  converged equilibrium of loaded_by(span, 0)
[[nodiscard]] SpanEquilibrium follow_loads(const RodSpan& span, const SpanEquilibrium& unloaded,
                                           double tolerance, const Deadline& deadline);

}  // namespace dlo::energy_model
