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

/// Distance of a shape from the rod of its scene (RMS): of its lowest state, or of the one near a
/// known equilibrium if the shape is nearer to that, as check() has it [m].
/// @param known  null: none. @throws as fit_material()
[[nodiscard]] double distance_from_rod(const Scene& scene, const MeasuredShape& shape,
                                       const MaterialFitOptions& options,
                                       const energy_model::Equilibrium* known = nullptr);

/// Whether two scenes have the same shape, but for how exactly a gripper is put back to its place.
[[nodiscard]] bool are_alike(const Scene& a, const Scene& b);

/// Returns what of "natural curvature" and "clamp directions" is not fitted, if the shapes are of
/// fewer than three different scenes: these may hide in such shapes without a residual.
[[nodiscard]] std::vector<std::string> unfitted_assumptions(const std::vector<Scene>& scenes,
                                                            const MaterialFitOptions& options);

/// What the fit to all others says of a shape.
struct PredictedScene {
  Scene scene;
  std::optional<energy_model::Equilibrium> known;  ///< near the state in which the rod was seen
};
using Predict = std::function<PredictedScene(std::size_t left)>;

/// Each shape predicted by the fit to all others with the same options.
/// @param fit  to all shapes, which says where along the rod their points are
/// @throws as fit_material()
[[nodiscard]] Prediction leave_one_out(const std::vector<Scene>& scenes,
                                       const std::vector<MeasuredShape>& shapes,
                                       const MaterialFitOptions& options, const MaterialFit& fit,
                                       const Predict& predict);

/// All but one.
template <typename Value>
[[nodiscard]] std::vector<Value> all_but(std::vector<Value> values, std::size_t left) {
  values.erase(values.begin() + static_cast<std::ptrdiff_t>(left));
  return values;
}

}  // namespace dlo::compare
