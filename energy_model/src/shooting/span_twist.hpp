#pragma once

#include "base/deadline.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// Twists a span by what its clamps ask for (Problem), from its equilibrium without twist on.
///
/// Natural continuation in the roll of the end's frame: Newton's method starts from a secant, or
/// else from the last shape; the steps grow where it takes few shots and are halved where it does
/// not converge or the shape jumps. Where a shape has become unstable, and where the branch ends at
/// a fold, the rod follows the gradient flow of its energy, by backward Euler, to a shape that is
/// stable at that roll.
/// @param span     twisted()
/// @param without  equilibrium without frames
/// @return not converged, and the roll that was reached in the message, if a step failed
[[nodiscard]] SpanEquilibrium twist_span(const RodSpan& span, const SpanEquilibrium& without,
                                         double tolerance, const Deadline& deadline);

/// The equilibrium with twist that Newton's method leads to from cross-sections at the nodes of a
/// mesh, with their torque and twist. The end's frame is held where the directors of the clamps
/// say, or if they do not where the start has it.
[[nodiscard]] SpanEquilibrium refine_twisted(const RodSpan& span, const RodMesh& mesh,
                                             std::vector<RodState> start, double tolerance,
                                             const Deadline& deadline);

}  // namespace dlo::energy_model
