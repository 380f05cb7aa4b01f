#pragma once

#include <vector>

#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Returns element boundaries (Span::cuts) with which few coefficients resolve a shape that is
/// known approximately: at the peaks of its curvature, for example where a soft rod turns back, and
/// on both sides of peaks, grips, loads and section changes, where their effect has decayed. The
/// coefficients on an element decrease with the distance of the nearest complex singularity,
/// measured in half lengths of the element, if it is next to the element's middle, but with the
/// square root of that distance if it is at its end.
[[nodiscard]] std::vector<double> piece_cuts(const SpanSolution& solution);

}  // namespace dlo::energy_model
