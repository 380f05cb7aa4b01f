#pragma once

#include <vector>

#include "figure/layout.hpp"
#include "figure/series.hpp"

namespace dlo::compare {

/// Shapes in one or two views at equal aspect, by construction: both axes have the same number of
/// pixels a metre.
[[nodiscard]] std::vector<Panel> shape_panels(const Drawing& drawing);

/// The same in space, in one plot.
[[nodiscard]] Panel spatial_panel(const Drawing& drawing);

/// Curvature of the series that have one against arc length.
[[nodiscard]] Panel curvature_panel(const std::vector<Series>& all, bool planar);

}  // namespace dlo::compare
