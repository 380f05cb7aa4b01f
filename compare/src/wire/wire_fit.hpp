#pragma once

#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "least_squares/material_point.hpp"
#include "least_squares/measured_shapes.hpp"

namespace dlo::compare {

/// Whether more than E and the density is to be fitted.
[[nodiscard]] bool fits_a_wire(const MaterialFitOptions& options);

/// Finds E, with `density` the density, and all other numbers that are asked for together, from the
/// material that fits best without them. Fills the result but for the degrees of freedom before.
/// @param measured  the shapes, whose time limit counts
/// @throws ConvergenceError if the steps lead nowhere, or the time limit is over
[[nodiscard]] MaterialFit fit_wire(const std::vector<Scene>& scenes,
                                   const std::vector<MeasuredShape>& shapes,
                                   MeasuredShapes& measured, const MaterialFitOptions& options,
                                   const MaterialPoint& start, bool density);

}  // namespace dlo::compare
