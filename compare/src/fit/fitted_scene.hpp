#pragma once

#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// A scene with the best estimates of the wire and of clamps that are alike in all scenes,
/// identified or not.
/// @param first  of the scenes that were fitted, as it was before
[[nodiscard]] Scene fitted_scene(Scene scene, const MaterialFit& fit, const Scene& first);

}  // namespace dlo::compare
