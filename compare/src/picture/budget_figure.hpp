#pragma once

#include "dlo/compare/comparison.hpp"
#include "figure/layout.hpp"

namespace dlo::compare {

/// Draws the error budget of a comparison as bars, one part below the other: its share of the total
/// with sign, and its RMS in words. Parts of less than 0.005 % are omitted.
[[nodiscard]] Figure budget_figure(const Comparison& comparison);

}  // namespace dlo::compare
