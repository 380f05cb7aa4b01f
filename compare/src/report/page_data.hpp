#pragma once

#include <string>

#include "report/report.hpp"

namespace dlo::compare {

/// What the page's script shows, as JSON that may stand in a script element: it has no "<".
///     scenes: [{name, length_m, spatial, view: [right, up], curves: [{name, kind, s, x, y, z,
///              curvature, tension?, distance?}], grippers: [{at, position, direction?}],
///              outlines: [{x, y, z}]}]
///     grid:   {gammas, angles_deg, points, models: [{law, bookkeeping}], cells: [{rod: {x, y},
///              polygon: {x, y}, s, distance, rms, max, max_at} or {failure}]}; null without one
/// SI units; lists of a cell are in ten thousandths of the length, its other numbers over the
/// length; `kind` is "rod", a smooth curve, or "polygon"; `distance` is that of a polygon's point
/// from the rod at equal arc length; z of the grid is 0.
[[nodiscard]] std::string page_data(const Report& report);

}  // namespace dlo::compare
