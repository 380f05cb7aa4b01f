#pragma once

#include <optional>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"
#include "least_squares/material_point.hpp"

namespace dlo::compare {

/// fit_material() with options as they are given, which it has checked.
/// @param start  of steps to all numbers, and to those of each prediction; none: all E are searched
[[nodiscard]] MaterialFit fit_from(const std::vector<Scene>& scenes,
                                   const std::vector<MeasuredShape>& shapes,
                                   const MaterialFitOptions& options,
                                   const std::optional<MaterialPoint>& start);

/// Each shape predicted by the fit to all others that begins from nothing.
/// @param fit  to all shapes, which says where along the rod their points are
/// @throws as fit_material()
[[nodiscard]] Prediction predict_each(const std::vector<Scene>& scenes,
                                      const std::vector<MeasuredShape>& shapes,
                                      const MaterialFitOptions& options, const MaterialFit& fit);

}  // namespace dlo::compare
