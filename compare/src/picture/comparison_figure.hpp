#pragma once

#include <string>
#include <vector>

#include "dlo/compare/comparison.hpp"
#include "dlo/compare/scene.hpp"
#include "figure/layout.hpp"
#include "figure/series.hpp"

namespace dlo::compare {

/// "law paper, bookkeeping paper, N = 16".
[[nodiscard]] std::string setting_name(const ForceModelSettings& settings);

/// What a picture shows of a scene's shapes.
[[nodiscard]] Drawing comparison_drawing(const Scene& scene,
                                         const std::vector<Comparison>& comparisons);

/// What figures show of a scene's comparisons.
struct ComparisonFigures {
  Figure shapes;     ///< of both models, at equal aspect
  Figure curvature;  ///< along the rod; its numbers are in the CSV file of the shapes
  Figure deviation;  ///< distance of the force model from the rod, along the rod
};

/// Of a scene; `number` (from 1) is part of their names.
/// @param comparisons  one or more of this scene: the first as the scene says, one more otherwise
[[nodiscard]] ComparisonFigures comparison_figures(const Scene& scene,
                                                   const std::vector<Comparison>& comparisons,
                                                   std::size_t number);

}  // namespace dlo::compare
