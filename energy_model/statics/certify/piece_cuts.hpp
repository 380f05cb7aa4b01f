#pragma once

#include <vector>

#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Where pieces of a span have to end so that few coefficients resolve a shape that is known
/// roughly (Span::cuts): at the peaks of its curvature, as where a soft rod turns back, and to both
/// sides of them and of grips, loads and sections, where what they do to it has decayed. A series
/// on a piece falls with the distance of its nearest complex singularity, in half lengths of the
/// piece, if that is beside the piece's middle, but with the root of it if that is at its end.
[[nodiscard]] std::vector<double> piece_cuts(const SpanSolution& solution);

}  // namespace dlo::energy_model
