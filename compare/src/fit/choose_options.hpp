#pragma once

#include <vector>

#include "dlo/compare/material_fit.hpp"
#include "fit/shape_misfit.hpp"

namespace dlo::compare {

/// The fit with those of the options by which each shape is predicted best from the others: so many
/// terms of natural curvature, with clamps as said, misaligned alike in all shapes or each on its
/// own. Its interval of E is widened to what the options say that predict nearly as well.
/// @param options  fit_material() has checked them
/// @throws ConvergenceError if no options lead to a fit; what else fit_material() throws
[[nodiscard]] MaterialFit fit_with_chosen_options(const std::vector<Scene>& scenes,
                                                  const std::vector<MeasuredShape>& shapes,
                                                  const MaterialFitOptions& options);

/// The material of a fit, identified or not, as factors on that of the first scene.
[[nodiscard]] MaterialPoint material_of(const MaterialFit& fit, const Scene& first);

/// fit_material() by steps from a material, without its search over all E; with `predict` so is
/// each shape's prediction.
[[nodiscard]] MaterialFit fit_material_from(const std::vector<Scene>& scenes,
                                            const std::vector<MeasuredShape>& shapes,
                                            const MaterialFitOptions& options,
                                            const MaterialPoint& start);

}  // namespace dlo::compare
