#pragma once

#include <optional>

#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::energy_model {

/// EI / (w l^3) below which a rod is a line to the models: the layers that bend at its ends are
/// shorter than 1e-5 l, which neither a series nor shots resolve.
inline constexpr double line_stiffness = 1e-10;

/// Whether the weight w per length of the rod makes its EI / (w l^3) less than line_stiffness.
[[nodiscard]] bool is_soft_line(const Problem& problem);

/// The equilibrium of a round, intrinsically straight rod of small EI / (w l^3) under its weight,
/// without loads and sections, that is held at both ends or hangs from a clamp at one: a catenary
/// of arc length s from its lowest point,
///     x = a asinh(s/a),  y = (a^2 + s^2)^(1/2),  tension T = w y,
/// and at each clamp, by phi_0 off the catenary's tangent, the layer in which a straight rod under
/// the tension there bends,
///     tan(phi/4) = tan(phi_0/4) exp(-sigma/lambda),  lambda = (EI/T)^(1/2).
/// The catenary ends where the layers' asymptotes do, 2 lambda (cos(phi_0/2) - 1) along its tangent
/// and 2 lambda sin(phi_0/2) across it. One rigid half-space below may carry a part, frictionless:
/// that part ends lambda before the catenary touches it, where w lambda presses on it alone.
///
/// `error_estimate`: what is neglected, of second order in lambda times the curvature. `residual`:
/// by how much the unit tangents, integrated from grip to grip, miss the other grip, over l. It is
/// stable, because it is pulled everywhere: int EI |eta'|^2 + T |eta|^2 ds > 0 for every change eta
/// of the tangent. Others are not looked for.
/// @return none of another problem, of a grip that bends the rod by more than 170 deg, and where
/// layers and what is touched are not apart
[[nodiscard]] std::optional<Equilibrium> soft_line(const Problem& problem);

/// The shape that solve_energy() and solve_exact() return without a search: taut_line(), or the
/// soft_line() of what is_soft_line() if its error_estimate stays below 1e-7 of the length; none of
/// another problem. Its balance is judged (balance.hpp), that of a soft line to its error_estimate.
/// @throws std::invalid_argument as taut_line()
[[nodiscard]] std::optional<Equilibrium> line_without_search(const Problem& problem);

}  // namespace dlo::energy_model
