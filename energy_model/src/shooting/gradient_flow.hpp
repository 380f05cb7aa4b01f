#pragma once

#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// Where the gradient flow t_ = -grad E of a clamped span leads, by backward Euler: a step of
/// duration D from the tangents p is the equilibrium next to them with
///     E + sum w |t - p|^2 / (2 D),
/// the sum over the nodes of multiple shooting with their share w of the length, where m jumps by
/// -w t x p / D. Steps are longer the less a step turns the tangents; the last ones
/// are Newton's method without p. Where that leads to an unstable shape, the flow starts beside it
/// again, along the mode of its smallest eigenvalue.
/// @param start    cross-sections at the nodes of the mesh; need not be an equilibrium
/// @param aim      tangents p of the first step at the nodes, near those of the start
/// @param frames  at its clamps
/// @return a stable equilibrium, or one that has not converged
[[nodiscard]] SpanEquilibrium follow_gradient(const RodSpan& span, const RodMesh& mesh,
                                              std::vector<RodState> start, Eigen::Matrix3Xd aim,
                                              const ClampFrames& frames,
                                              const ShootingOptions& options);

/// The flow from beside an unstable equilibrium.
[[nodiscard]] SpanEquilibrium leave_saddle(const RodSpan& span, const SpanEquilibrium& saddle,
                                           const ShootingOptions& options);

/// Changes of the tangents in the mode of the smallest eigenvalue of an equilibrium, at arc
/// lengths, the largest of length 1. The equilibrium has to know the mode.
[[nodiscard]] Eigen::Matrix3Xd tangent_mode(const RodSpan& span, const SpanEquilibrium& equilibrium,
                                            const Eigen::VectorXd& s);

}  // namespace dlo::energy_model
