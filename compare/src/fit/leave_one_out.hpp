#pragma once

#include <vector>

#include "dlo/compare/material_fit.hpp"

namespace dlo::compare {

/// Each shape predicted by the fit to all others with the same options.
/// @param fit  to all shapes, which says where along the rod their points are
/// @throws as fit_material()
[[nodiscard]] Prediction leave_one_out(const std::vector<Scene>& scenes,
                                       const std::vector<MeasuredShape>& shapes,
                                       const MaterialFitOptions& options, const MaterialFit& fit);

}  // namespace dlo::compare
