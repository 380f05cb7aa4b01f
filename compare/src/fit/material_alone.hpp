#pragma once

#include <optional>
#include <string>

#include "dlo/compare/fitted_material.hpp"
#include "fit/material_profiles.hpp"

namespace dlo::compare {

/// Fits E and, if identifiable, the density, without other numbers.
/// @throws ConvergenceError if a rod within the interval is not verified on its obstacles
[[nodiscard]] MaterialFit fit_material_alone(MaterialProfiles& material,
                                             const MaterialProfiles::Search& found);

/// Returns MaterialFit::warning if the residuals are too large; empty if they are not.
/// @param squares  sum of their squares [m^2]
/// @param noise  given noise, unless the interval already accounts for larger residuals
[[nodiscard]] std::string warning_of(const MaterialProfiles& material, double squares,
                                     const std::optional<double>& noise);

}  // namespace dlo::compare
