#pragma once

#include <string>

#include "dlo/compare/comparison.hpp"
#include "dlo/compare/scene.hpp"
#include "figure/layout.hpp"
#include "figure/series.hpp"

namespace dlo::compare {

/// "law paper, bookkeeping paper, N = 16".
[[nodiscard]] std::string setting_name(const ForceModelSettings& settings);

/// What a picture shows of a scene's shapes.
[[nodiscard]] Drawing comparison_drawing(const Scene& scene, const Comparison& comparison);

/// Figures of a comparison.
struct ComparisonFigures {
  Figure shapes;     ///< of both models, at equal aspect
  Figure curvature;  ///< along the rod
  Figure deviation;  ///< distance of the force model from the rod, along the rod
};

/// Draws a comparison of a scene.
[[nodiscard]] ComparisonFigures comparison_figures(const Scene& scene,
                                                   const Comparison& comparison);

}  // namespace dlo::compare
