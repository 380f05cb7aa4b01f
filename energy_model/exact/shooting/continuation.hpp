#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/deadline.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// Rotates the frames of a span's clamps simultaneously to the held ones (Problem), starting from
/// its equilibrium with released frames.
///
/// This is natural continuation in the roll. If a shape has become unstable, and where the branch
/// ends at a fold, the rod follows the gradient flow of its energy to a shape that is stable at
/// that roll.
/// @param span     a twisted() span
/// @param without  equilibrium without frames after the first clamp
/// @return not converged if a step failed; the message then states the roll that was reached
[[nodiscard]] SpanEquilibrium twist_span(const RodSpan& span, const SpanEquilibrium& without,
                                         double tolerance, const Deadline& deadline);

/// Follows an equilibrium while loads without a potential grow from zero
/// (scale_nonpotential_loads()), by natural continuation in their share. It does not pass a fold:
/// the result is then not converged, and the message states the share of the loads that was
/// reached.
/// @param unloaded  converged equilibrium of scale_nonpotential_loads(span, 0)
[[nodiscard]] SpanEquilibrium follow_loads(const RodSpan& span, const SpanEquilibrium& unloaded,
                                           double tolerance, const Deadline& deadline);

/// Continues an equilibrium of the inextensible span to the span that stretches, by natural
/// continuation in the stretch. It does not leave unstable equilibria.
/// @param rigid  equilibrium of with_stretch_share(span, 0)
[[nodiscard]] SpanEquilibrium stretch_span(const RodSpan& span, const SpanEquilibrium& rigid,
                                           double tolerance, const Deadline& deadline);

[[nodiscard]] RodSpan with_stretch_share(RodSpan span, double share);

/// Follows the gradient flow t_ = -grad E of a clamped span to a stable equilibrium, by backward
/// Euler. A step of duration D from the tangents p is the adjacent equilibrium of
///     E + sum w |t - p|^2 / (2 D),
/// with the sum over the nodes of multiple shooting and their share w of the length; m jumps by -w
/// t x p / D at a node. For a rod that is not round, whose roll about given tangents may be
/// unstable too, the sum contains d1 as well. Steps are longer the less a step rotates the
/// tangents; the last ones are Newton's method without p. If the result is unstable, the flow
/// starts again beside it, along the mode of its smallest eigenvalue.
/// @param start   cross-sections at the nodes of the mesh; need not be an equilibrium
/// @param aim     frames at the nodes, near those of the start, whose tangents and d1 are p of the
///             first step
/// @param frames  frames at the clamps
/// @return a stable equilibrium, or one that has not converged
[[nodiscard]] SpanEquilibrium follow_gradient(const RodSpan& span, const RodMesh& mesh,
                                              std::vector<RodState> start,
                                              std::vector<Eigen::Matrix3d> aim,
                                              const ClampFrames& frames,
                                              const ShootingOptions& options);

/// Follows the gradient flow from beside an unstable equilibrium, on one side of it and, if that
/// does not converge, on the other.
[[nodiscard]] SpanEquilibrium leave_saddle(const RodSpan& span, const SpanEquilibrium& saddle,
                                           const ShootingOptions& options);

}  // namespace dlo::energy_model
