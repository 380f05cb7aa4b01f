#pragma once

#include "touching/contact_chain.hpp"

namespace dlo::energy_model {

/// Whether the second variation of a closed chain is positive on what its grips and contacts leave,
/// with a multiple of its norm int |eta'|^2 + |eta|^2 ds taken off it,
///     int |eta'|^2 + (n.t - |v|^2) |eta|^2 ds
///         - sum f dr.(H dr) + sum f (N.eta + dr.(H t))^2 / g'' - int p dr.(H dr) ds,
/// eta = dt across t, dr = int eta, H the normal's derivative, f the forces at touching points and
/// lift-offs, g'' that of the gap where the rod touches at a point and may slide. dr = 0 at grips,
/// eta = 0 at clamps, N.dr = 0 where the rod touches or lies. By linear elements, eight to an arc,
/// and Cholesky's factors of their matrix on the constraints' null space.
/// @param margin  1e-3; -1e-3 puts it on: what is not stable then is a saddle
[[nodiscard]] bool is_stable(const ContactChain& chain, double margin);

}  // namespace dlo::energy_model
