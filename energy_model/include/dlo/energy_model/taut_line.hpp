#pragma once

#include <optional>

#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::energy_model {

/// Whether the grips hold the whole rod on a line that is as long as the rod, to 1e-12 of its
/// length, and every grip is on that line, to 1e-9. The line is then the only shape of an
/// inextensible rod.
[[nodiscard]] bool is_taut_line(const Problem& problem);

/// Computes the equilibrium of a round, intrinsically straight rod that is_taut_line(), without
/// obstacles, drag and loads that follow it; std::nullopt for another problem.
/// Problem::axial_stiffness is ignored. Twist between clamps that hold frames is distributed by its
/// compliance. The shape of an inextensible rod does not determine its tension: the forces are
/// those of a uniform rod in the limit of infinite stretch stiffness that is unstressed at this
/// length. Weight and loads between two grips have to be along the line. The two grips carry them
/// in proportion to the distance from the other grip. A load at a grip is carried by that grip, a
/// couple on a clamp by that clamp.
/// @throws std::invalid_argument if the problem is out of range; if a clamp's direction is not
/// along the line; if a force across the line acts between grips, which no tension could balance;
/// or if a couple acts elsewhere than on a clamp, because its distribution to the grips depends on
/// the tension
[[nodiscard]] std::optional<Equilibrium> taut_line(const Problem& problem);

}  // namespace dlo::energy_model
