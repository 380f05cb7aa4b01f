#pragma once

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "least_squares/material_point.hpp"

namespace dlo::compare {

/// Returns a scene with the best estimates of the wire, and of the clamp errors and the camera's
/// tilt that all scenes share, whether identified or not.
/// @param first  the first of the fitted scenes, as it was before the fit
[[nodiscard]] Scene fitted_scene(Scene scene, const MaterialFit& fit, const Scene& first);

/// Returns the material of a fit, whether identified or not, as factors on that of the first scene.
[[nodiscard]] MaterialPoint material_of(const MaterialFit& fit, const Scene& first);

}  // namespace dlo::compare
