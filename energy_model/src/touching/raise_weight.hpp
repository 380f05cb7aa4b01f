#pragma once

#include <optional>

#include "base/deadline.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// A loaded rod with one clamp at its begin over rigid half-spaces: weight and loads are raised
/// from nothing, and the end comes down, touches and lies as the contact's signs say, each step
/// close_contacts() from the one before; confirm_contacts() judges the last one.
/// @param tolerance  of the integrator
/// @return nothing where the problem is another one
[[nodiscard]] std::optional<Equilibrium> raise_weight(const Problem& problem, double tolerance,
                                                      const Deadline& deadline);

}  // namespace dlo::energy_model
