#pragma once

#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "least_squares/fitted_rods.hpp"
#include "least_squares/measured_shapes.hpp"

namespace dlo::compare {

/// Whether more than E and the density is fitted.
[[nodiscard]] bool fits_a_wire(const MaterialFitOptions& options);

/// Fits E, with `density` the density, and all other requested numbers together, starting from the
/// material that fits best without them. Sets all of the result except the counts of equilibria and
/// evaluations, `assumed`, `chains`, and what only searches for other options set (`common_share`,
/// `alternatives`, `tried`).
/// @param measured  the shapes, with their time limit
/// @throws InputError as wire_numbers(), or if too few coordinates are measured to estimate noise;
/// ConvergenceError if a shape has no equilibrium near the fit, or the time limit is exceeded
[[nodiscard]] MaterialFit fit_wire(const std::vector<Scene>& scenes,
                                   const std::vector<MeasuredShape>& shapes,
                                   MeasuredShapes& measured, const MaterialFitOptions& options,
                                   const MaterialPoint& start, bool density);

}  // namespace dlo::compare
