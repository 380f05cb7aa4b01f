#pragma once

#include <Eigen/Core>
#include <vector>

#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {

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

/// Follows the gradient flow from beside an unstable equilibrium, on one side of it and then on the
/// other.
[[nodiscard]] SpanEquilibrium leave_saddle(const RodSpan& span, const SpanEquilibrium& saddle,
                                           const ShootingOptions& options);

}  // namespace dlo::energy_model
