#pragma once

#include <string>
#include <vector>

#include "dlo/compare/material_fit.hpp"
#include "figure/layout.hpp"

namespace dlo::compare {

/// A fitted material: each shape's points on the rod that was fitted, and the profile likelihood
/// of the stiffness with its interval.
/// @param scenes  one for each of the fit's shapes
/// @param fit     with MaterialFitOptions::profile_points
[[nodiscard]] Picture fit_picture(const std::vector<Scene>& scenes, const MaterialFit& fit);

}  // namespace dlo::compare
