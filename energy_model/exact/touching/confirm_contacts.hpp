#pragma once

#include <optional>

#include "base/deadline.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// Returns the equilibrium near a shape that states which parts of the rod touch which obstacles,
/// for an intrinsically straight rod with any grips on rigid bodies of any shape. The result is
/// verified here: gaps, forces and pressures of the right sign, and a positive second variation.
/// @param shape      shape of this problem or of a similar one, with the reactions of its grips and
///               its contacts
/// @param tolerance  local error of the integrator
/// @return std::nullopt for another kind of problem, and for contacts that are not supported: a
/// point contact at a grip, a load or a change of section, a part that lies across one of these, or
/// two parts that lie next to each other
[[nodiscard]] std::optional<Equilibrium> confirm_contacts(const Problem& problem,
                                                          const Equilibrium& shape,
                                                          double tolerance,
                                                          const Deadline& deadline);

}  // namespace dlo::energy_model
