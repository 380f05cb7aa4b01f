#pragma once

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "least_squares/material_point.hpp"

namespace dlo::compare {

/// A scene with the best estimates of the wire and of clamps that are alike in all scenes,
/// identified or not.
/// @param first  of the scenes that were fitted, as it was before
[[nodiscard]] Scene fitted_scene(Scene scene, const MaterialFit& fit, const Scene& first);

/// The material of a fit, identified or not, as factors on that of the first scene.
[[nodiscard]] MaterialPoint material_of(const MaterialFit& fit, const Scene& first);

}  // namespace dlo::compare
