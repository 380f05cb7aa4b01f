#pragma once

#include <optional>
#include <string>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "least_squares/log_profile.hpp"

namespace dlo::compare {

/// Whether a force acts on the rod that does not grow with its stiffness: weight, a load, an
/// obstacle that yields. Without one its energy is E times a function of the shape alone, so the
/// scene has the same equilibria with every E.
[[nodiscard]] bool is_forced(const Scene& scene);

/// The same but for its weight, without which it has the same ones with every density / E.
[[nodiscard]] bool has_forces_beside_weight(const Scene& scene);

/// What is not identifiable from shapes of scenes that are not is_forced(), in words.
[[nodiscard]] std::string why_unforced(const Scene& scene);

/// Half the width of a 95 % interval in standard deviations: the normal's of a given noise, else
/// Student's t.
/// @param noise  given;  @param freedom  degrees, of the residuals from which it is estimated
[[nodiscard]] double interval_quantile(const std::optional<double>& noise, double freedom);

/// A number that is fitted as the logarithm of its factor on what the scene says.
/// @param interval  of that logarithm;  @param unit  what the scene says
/// @param identified_within  see MaterialFitOptions
[[nodiscard]] FittedValue fitted_value(double logarithm, const LogProfile::Interval& interval,
                                       double unit, double identified_within);

}  // namespace dlo::compare
