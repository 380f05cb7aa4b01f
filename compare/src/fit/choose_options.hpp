#pragma once

#include <vector>

#include "dlo/compare/material_fit.hpp"

namespace dlo::compare {

/// The fit with those of the options by which each shape is predicted best from the others:
/// so many terms of natural curvature, with clamps as said or misaligned alike in all shapes. Its
/// interval of E is widened to what the options say that predict nearly as well.
/// @throws InputError of fewer than three shapes
[[nodiscard]] MaterialFit fit_with_chosen_options(const std::vector<Scene>& scenes,
                                                  const std::vector<MeasuredShape>& shapes,
                                                  const MaterialFitOptions& options);

}  // namespace dlo::compare
