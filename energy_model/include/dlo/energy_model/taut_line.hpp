#pragma once

#include <optional>

#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::energy_model {

/// Whether grips hold all of the rod at its own length on one line, to 1e-12 of it: then that line
/// is its only shape.
[[nodiscard]] bool is_taut_line(const Problem& problem);

/// The equilibrium of a round, intrinsically straight rod that is_taut_line() without obstacles;
/// none of another problem. Twist between clamps that hold frames is spread by its compliance. What
/// does not stretch does not say its tension: the forces are those of a uniform rod that stretches
/// ever less and is unstressed at this length. Weight and loads between two grips, which have to be
/// along the line, are carried by the two in the shares of their distances, a load at a grip by
/// that grip, a couple on a clamp by that clamp.
/// @throws std::invalid_argument if a clamp's direction is not along the line, if a force across it
///         acts between grips, which no tension could balance, or if a couple acts elsewhere than
///         on a clamp: how grips share it depends on the tension
[[nodiscard]] std::optional<Equilibrium> taut_line(const Problem& problem);

}  // namespace dlo::energy_model
