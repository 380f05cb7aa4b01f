#pragma once

#include <optional>
#include <string>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "least_squares/log_profile.hpp"

namespace dlo::compare {

/// Whether a force acts on the rod that is not proportional to its stiffness: weight, a load, or a
/// yielding obstacle. Without one the energy is E times a function of the shape, so the scene has
/// the same equilibria for every E.
[[nodiscard]] bool has_external_force(const Scene& scene);

/// Whether a load or a yielding obstacle acts on the rod. Otherwise the scene has the same
/// equilibria for every E at a fixed ratio of density and E.
[[nodiscard]] bool has_forces_beside_weight(const Scene& scene);

/// Returns a message that states why the stiffness is not identifiable from shapes of a scene that
/// is not has_external_force().
[[nodiscard]] std::string why_stiffness_not_identifiable(const Scene& scene);

/// Returns half the width of a 95 % interval in standard deviations: of the normal distribution if
/// the noise is given, otherwise of Student's t distribution.
/// @param noise  given noise [m]
/// @param freedom  degrees of freedom of the residuals from which noise is estimated
[[nodiscard]] double interval_quantile(const std::optional<double>& noise, double freedom);

/// Returns a value that was fitted as the logarithm of its ratio to the scene's value.
/// @param interval  of the logarithm;  @param unit  the scene's value
/// @param largest_interval_ratio  see MaterialFitOptions
[[nodiscard]] FittedValue fitted_value(double logarithm, const LogProfile::Interval& interval,
                                       double unit, double largest_interval_ratio);

/// Extends the interval of a value to include that of another fit. A value whose interval is then
/// too wide is not identified.
/// @return whether the value is identified
bool include_interval(FittedValue& value, const FittedValue& other, double largest_interval_ratio);

}  // namespace dlo::compare
