#pragma once

#include <string_view>

#include "dlo/energy_model/vibrations.hpp"

namespace dlo::energy_model {

/// @throws std::invalid_argument naming what of it is out of range, and the function
void check(const Problem& problem, const Inertia& inertia, std::string_view function);

/// Of the rod and what hangs on it [kg].
[[nodiscard]] double total_mass(const Problem& problem, const Inertia& inertia);

/// At an arc length [kg/m].
[[nodiscard]] double mass_per_length(const Problem& problem, const Inertia& inertia, double at);

}  // namespace dlo::energy_model
