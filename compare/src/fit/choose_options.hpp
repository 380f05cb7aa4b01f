#pragma once

#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {

/// The fit with those of the options by which each shape is predicted best from the others: so many
/// terms of natural curvature, with clamps as said, misaligned alike in all shapes or each on its
/// own. Its interval of E is widened to what the options say that predict nearly as well.
/// @param options  fit_material() has checked them
/// @throws ConvergenceError if no options lead to a fit; what else fit_material() throws
[[nodiscard]] MaterialFit fit_with_chosen_options(const std::vector<Scene>& scenes,
                                                  const std::vector<MeasuredShape>& shapes,
                                                  const MaterialFitOptions& options);

}  // namespace dlo::compare
