#pragma once

#include <optional>
#include <string>

#include "dlo/compare/fitted_material.hpp"
#include "fit/material_profiles.hpp"

namespace dlo::compare {

/// The fit of E, and where it can be told the density, with nothing else.
/// @throws ConvergenceError if a rod within the interval is not verified on its obstacles
[[nodiscard]] MaterialFit fit_material_alone(MaterialProfiles& material,
                                             const MaterialProfiles::Search& found);

/// MaterialFit::warning of residuals that are too large; empty: they are not.
/// @param squares  their sum [m^2];  @param noise  given, if the interval does not allow for more
[[nodiscard]] std::string warning_of(const MaterialProfiles& material, double squares,
                                     const std::optional<double>& noise);

}  // namespace dlo::compare
