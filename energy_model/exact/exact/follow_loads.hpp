#pragma once

#include "base/deadline.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// The equilibrium that an unloaded one goes over into while loads without a potential grow from
/// nothing (loaded_by()): continuation with a secant predictor, whose steps are as long as Newton's
/// method turns no tangent by more than half a radian from what is predicted. It does not pass a
/// fold: then it has not converged, and the message says at which part of the loads.
/// @param unloaded  of loaded_by(span, 0), which has converged
[[nodiscard]] SpanEquilibrium follow_loads(const RodSpan& span, const SpanEquilibrium& unloaded,
                                           double tolerance, const Deadline& deadline);

}  // namespace dlo::energy_model
