#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Distance of a shape from the rod of its scene (RMS) [m]. @throws as fit_material()
[[nodiscard]] double distance_from_rod(const Scene& scene, const MeasuredShape& shape,
                                       const MaterialFitOptions& options);

/// The scene of a shape as the fit to all others says.
using PredictedScene = std::function<Scene(std::size_t left)>;

/// Each shape predicted by the fit to all others with the same options.
/// @param fit  to all shapes, which says where along the rod their points are
/// @throws as fit_material()
[[nodiscard]] Prediction leave_one_out(const std::vector<Scene>& scenes,
                                       const std::vector<MeasuredShape>& shapes,
                                       const MaterialFitOptions& options, const MaterialFit& fit,
                                       const PredictedScene& predicted);

/// The same where every fit begins from nothing.
[[nodiscard]] Prediction leave_one_out(const std::vector<Scene>& scenes,
                                       const std::vector<MeasuredShape>& shapes,
                                       const MaterialFitOptions& options, const MaterialFit& fit);

/// All but one.
template <typename Value>
[[nodiscard]] std::vector<Value> all_but(std::vector<Value> values, std::size_t left) {
  values.erase(values.begin() + static_cast<std::ptrdiff_t>(left));
  return values;
}

}  // namespace dlo::compare
