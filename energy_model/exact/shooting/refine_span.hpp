#pragma once

#include <Eigen/Core>

#include "base/deadline.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// Returns the equilibrium to which Newton's method converges from a shape of the span's problem,
/// or of a similar one. If the shape has no `twists` for a round span, the span is refined without
/// twist and then twisted. Material directors are those of the shape's d1. If it has none, they
/// rotate from those of the first clamp by the torque that the grips' reactions imply.
/// @throws std::invalid_argument if the span is not round and has no clamp, or if its loads are too
/// large (check_load())
[[nodiscard]] SpanEquilibrium refine_span(const RodSpan& span, const Problem& problem,
                                          const Equilibrium& shape, double tolerance,
                                          const Deadline& deadline);

/// Returns the force of the part beyond the arc length s (over l) on the part before, just after s,
/// that the grips' forces of a shape imply, in EI/l^2.
[[nodiscard]] Eigen::Vector3d implied_force(const Problem& problem, const Equilibrium& shape,
                                            double s);

}  // namespace dlo::energy_model
