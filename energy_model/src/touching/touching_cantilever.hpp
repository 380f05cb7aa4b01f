#pragma once

#include <optional>

#include "base/deadline.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// A heavy rod with one clamp at its begin over rigid half-spaces across its plane: its weight is
/// raised from nothing, and the end comes down, touches and lies as the contact's signs say.
/// @return nothing where the problem is another one
[[nodiscard]] std::optional<Equilibrium> solve_touching_cantilever(const Problem& problem,
                                                                   const Deadline& deadline);

}  // namespace dlo::energy_model
