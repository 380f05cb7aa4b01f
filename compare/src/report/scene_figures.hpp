#pragma once

#include <cstddef>
#include <vector>

#include "report/gnuplot.hpp"
#include "report/report.hpp"

namespace dlo::compare {

/// Shapes and curvature of a scene; `number` (from 1) is part of their names.
[[nodiscard]] std::vector<Figure> scene_figures(const SceneReport& scene, std::size_t number);

}  // namespace dlo::compare
