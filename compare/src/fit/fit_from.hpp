#pragma once

#include <optional>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"
#include "least_squares/fitted_rods.hpp"

namespace dlo::compare {

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

}  // namespace dlo::compare
