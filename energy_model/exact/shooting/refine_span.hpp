#pragma once

#include <Eigen/Core>

#include "base/deadline.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// The equilibrium that Newton's method leads to from a shape of the problem that the span is of,
/// or of a similar one. A shape that says nothing of the twist of a round span is refined without
/// it and then twisted. Material directors are those of the shape's d1, or turn from the first
/// clamp's by the torque that its grips imply where it has none.
/// @throws std::invalid_argument if the span is not round and has no clamp
[[nodiscard]] SpanEquilibrium refine_span(const RodSpan& span, const Problem& problem,
                                          const Equilibrium& shape, double tolerance,
                                          const Deadline& deadline);

/// Force of what lies beyond the arc length s (over l) on what lies before, just after it, that the
/// grips' forces of a shape imply, in EI/l^2.
[[nodiscard]] Eigen::Vector3d implied_force(const Problem& problem, const Equilibrium& shape,
                                            double s);

}  // namespace dlo::energy_model
