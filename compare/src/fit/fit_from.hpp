#pragma once

#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"
#include "least_squares/fitted_rods.hpp"

namespace dlo::compare {

/// Number of terms of natural curvature that are tried if the options do not request more.
inline constexpr int default_curvature_terms = 3;
/// Default tolerance of the clamp directions of a fixture: they are hardly known [rad].
inline constexpr double fixture_tolerance = 20 * std::numbers::pi / 180;
/// Default tolerance of the tilt of a camera [rad].
inline constexpr double default_tilt_tolerance = 2 * std::numbers::pi / 180;
/// Smallest number of shapes with which each one can be predicted by the others.
inline constexpr std::size_t least_shapes_for_prediction = 3;

/// Returns a scene with the best estimates of the wire, and of the clamp errors and the camera's
/// tilt that all scenes share, whether identified or not.
/// @param first  the first of the fitted scenes, as it was before the fit
[[nodiscard]] Scene fitted_scene(Scene scene, const MaterialFit& fit, const Scene& first);

/// Returns the material of a fit, whether identified or not, as factors on that of the first scene.
[[nodiscard]] MaterialPoint material_point_of(const MaterialFit& fit, const Scene& first);

/// Fits the material with the given options, which fit_material() has checked.
/// @param start  material from which all numbers are fitted together; predictions then start at the
/// fit. Empty: all E are searched
[[nodiscard]] MaterialFit fit_material_from(const std::vector<Scene>& scenes,
                                            const std::vector<MeasuredShape>& shapes,
                                            const MaterialFitOptions& options,
                                            const std::optional<MaterialPoint>& start);

/// Fits the material with the options that predict each shape best from the others: the number of
/// terms of natural curvature, and whether clamps are as given, misaligned equally in all shapes,
/// or misaligned in each shape. The interval of E is widened to that of the largest number of terms
/// that predicts nearly as well. Returns the fit of the material alone if its residuals are noise.
/// @param options  checked by fit_material()
/// @throws ConvergenceError if no options result in a fit; other exceptions as fit_material()
[[nodiscard]] MaterialFit fit_with_chosen_options(const std::vector<Scene>& scenes,
                                                  const std::vector<MeasuredShape>& shapes,
                                                  const MaterialFitOptions& options);

}  // namespace dlo::compare
