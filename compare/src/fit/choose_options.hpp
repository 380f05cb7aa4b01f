#pragma once

#include <cstddef>
#include <numbers>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {

/// Number of terms of natural curvature that are tried where the options do not ask for more.
inline constexpr int usual_curvature_terms = 3;
/// How well the clamps of a fixture are known where the options do not say: hardly [rad].
inline constexpr double fixture_tolerance = 20 * std::numbers::pi / 180;
/// How level a camera is where the options do not say [rad].
inline constexpr double usual_tilt = 2 * std::numbers::pi / 180;
/// Number of shapes from which each can be predicted by the others.
inline constexpr std::size_t fewest_predicted = 3;

/// The fit with those of the options by which each shape is predicted best from the others: so many
/// terms of natural curvature, with clamps as said, misaligned alike in all shapes or each on its
/// own. Its interval of E is widened to what the options say that predict nearly as well.
/// @param options  fit_material() has checked them
/// @throws ConvergenceError if no options lead to a fit; what else fit_material() throws
[[nodiscard]] MaterialFit fit_with_chosen_options(const std::vector<Scene>& scenes,
                                                  const std::vector<MeasuredShape>& shapes,
                                                  const MaterialFitOptions& options);

}  // namespace dlo::compare
