#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/energy.hpp"

namespace dlo::compare {

/// Returns the RMS distance of a shape from the rod of its scene [m]: from the lowest state, or
/// from the state near a known equilibrium if that is nearer, as in check().
/// @param known  null: none. @throws in the cases of fit_material()
[[nodiscard]] double distance_from_rod(const Scene& scene, const MeasuredShape& shape,
                                       const MaterialFitOptions& options,
                                       const energy_model::Equilibrium* known = nullptr);

/// Returns which of "natural curvature" and "clamp directions" are not fitted, if the shapes are of
/// fewer than three different scenes: an error of these may then leave no residual. "clamp
/// directions" requires a clamp in the first scene.
[[nodiscard]] std::vector<std::string> unfitted_assumptions(const std::vector<Scene>& scenes,
                                                            const MaterialFitOptions& options);

/// Scene of a shape as predicted by the fit to all other shapes.
struct PredictedScene {
  Scene scene;
  std::optional<energy_model::Equilibrium> known;  ///< equilibrium near the observed one
};
using Predict = std::function<PredictedScene(std::size_t excluded)>;

/// Predicts each shape by the fit to all others with the same options, and returns the distances.
/// @param fit  fit to all shapes, which determines the arc lengths of their points
/// @throws in the cases of fit_material()
[[nodiscard]] Prediction leave_one_out(const std::vector<Scene>& scenes,
                                       const std::vector<MeasuredShape>& shapes,
                                       const MaterialFitOptions& options, const MaterialFit& fit,
                                       const Predict& predict);

template <typename Value>
[[nodiscard]] std::vector<Value> without_one(std::vector<Value> values, std::size_t excluded) {
  values.erase(values.begin() + static_cast<std::ptrdiff_t>(excluded));
  return values;
}

}  // namespace dlo::compare
