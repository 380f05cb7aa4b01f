#pragma once

#include <Eigen/Core>
#include <vector>

#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

/// Where the gradient flow t_ = -grad E of a clamped span leads, by backward Euler: a step of
/// duration D from the tangents p is the equilibrium next to them with
///     E + sum w |t - p|^2 / (2 D),
/// the sum over the nodes of multiple shooting with their share w of the length, where m jumps by
/// -w t x p / D. A rod that is not round, whose roll about given tangents may be unstable too, has
/// d1 in the sum as well. Steps are longer the less a step turns the tangents; the last ones
/// are Newton's method without p. Where that leads to an unstable shape, the flow starts beside it
/// again, along the mode of its smallest eigenvalue.
/// @param start    cross-sections at the nodes of the mesh; need not be an equilibrium
/// @param aim      frames at the nodes whose tangents, and d1, are p of the first step, near the
/// start's
/// @param frames  at its clamps
/// @return a stable equilibrium, or one that has not converged
[[nodiscard]] SpanEquilibrium follow_gradient(const RodSpan& span, const RodMesh& mesh,
                                              std::vector<RodState> start,
                                              std::vector<Eigen::Matrix3d> aim,
                                              const ClampFrames& frames,
                                              const ShootingOptions& options);

/// The flow from beside an unstable equilibrium.
[[nodiscard]] SpanEquilibrium leave_saddle(const RodSpan& span, const SpanEquilibrium& saddle,
                                           const ShootingOptions& options);

}  // namespace dlo::energy_model
