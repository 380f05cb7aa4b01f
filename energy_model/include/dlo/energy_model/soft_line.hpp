#pragma once

#include <optional>

#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::energy_model {

/// EI / (w l^3) below which both models return catenary_limit(), if that applies and is accurate
/// enough (shape_without_search()). Under a tension of w l the bending layers at the ends are then
/// shorter than 1e-5 l, which neither a series nor shots resolve.
inline constexpr double catenary_limit_stiffness = 1e-10;

/// Whether EI / (w l^3) of the rod, w its weight per length, is less than catenary_limit_stiffness.
[[nodiscard]] bool is_catenary_limit(const Problem& problem);

/// Computes the equilibrium of a round, intrinsically straight rod of small EI / (w l^3) under its
/// weight, without loads and sections, that is held at both ends or hangs from a clamp at one. It
/// is a catenary of arc length s from its lowest point,
///     x = a asinh(s/a),  y = (a^2 + s^2)^(1/2),  tension T = w y,
/// and at each clamp, whose direction is at an angle phi_0 from the catenary's tangent, the layer
/// in which a straight rod bends under the tension there,
///     tan(phi/4) = tan(phi_0/4) exp(-sigma/lambda),  lambda = (EI/T)^(1/2).
/// The catenary ends where the asymptotes of the layers end, at 2 lambda (cos(phi_0/2) - 1) along
/// its tangent and 2 lambda sin(phi_0/2) across it. One rigid half-space below may carry a part,
/// without friction: that part ends lambda before the catenary touches the half-space, and a
/// concentrated force w lambda acts at its end.
///
/// `error_estimate` estimates the neglected terms, which are of second order in lambda times the
/// curvature. `residual` is the gap between the integral of the unit tangents from end to end and
/// the position of the other end of the rod, divided by l. The shape is stable because it is under
/// tension everywhere: int EI |eta'|^2 + T |eta|^2 ds > 0 for every change eta of the tangent.
/// Other equilibria are not searched for.
/// @return std::nullopt if the problem is of another kind or the limit does not describe it, as for
/// grips above each other, a clamp that bends the rod by 170 deg or more, and layers that overlap
/// @throws std::invalid_argument if the problem is out of range
[[nodiscard]] std::optional<Equilibrium> catenary_limit(const Problem& problem);

/// Returns the shape that solve_energy() and solve_exact() return without a search: taut_line(), or
/// catenary_limit() if is_catenary_limit() and its error_estimate is at most 1e-7 of the length;
/// else std::nullopt. The balance is verified (balance.hpp), for a soft line to its error_estimate.
/// @throws std::invalid_argument as taut_line()
[[nodiscard]] std::optional<Equilibrium> shape_without_search(const Problem& problem);

}  // namespace dlo::energy_model
