#pragma once

#include "kirchhoff/rod_span.hpp"
#include "shooting/boundary_value.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// Where the gradient flow t_ = -grad E of a clamped span leads, by backward Euler: a step of
/// duration D from the tangents p is the equilibrium next to them with
///     E + sum w |t - p|^2 / (2 D),
/// the sum over the nodes of multiple shooting with their share w of the length, where t' jumps by
/// -w (p - (p.t) t) / D. Steps are longer the less a step turns the tangents; the last ones
/// are Newton's method without p. Where that leads to an unstable shape, the flow starts beside it
/// again, along the mode of its smallest eigenvalue.
/// @param start    cross-sections at the nodes of the mesh; need not be an equilibrium
/// @param aim      tangents p of the first step at the nodes, near those of the start
/// @param options  with frames
/// @return a stable equilibrium, or one that has not converged
[[nodiscard]] SpanEquilibrium follow_gradient(const RodSpan& span, const RodMesh& mesh,
                                              std::vector<RodState> start, Eigen::Matrix3Xd aim,
                                              const ShootingOptions& options);

/// The flow from beside an unstable equilibrium.
[[nodiscard]] SpanEquilibrium leave_saddle(const RodSpan& span, const SpanEquilibrium& saddle,
                                           const ShootingOptions& options);

}  // namespace dlo::energy_model
