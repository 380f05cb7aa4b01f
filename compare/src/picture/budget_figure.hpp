#pragma once

#include <cstddef>
#include <vector>

#include "dlo/compare/comparison.hpp"
#include "figure/layout.hpp"

namespace dlo::compare {

/// The error budgets of a scene's comparisons as bars, a part below the other: their share of the
/// total with sign, and their RMS in words; `number` (from 1) is part of its name.
[[nodiscard]] Figure budget_figure(const std::vector<Comparison>& comparisons, std::size_t number);

}  // namespace dlo::compare
