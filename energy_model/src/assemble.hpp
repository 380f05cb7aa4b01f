#pragma once

#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "span_solution.hpp"
#include "split.hpp"

namespace dlo::energy_model {

/// One solution of each span, put together in space and SI units.
[[nodiscard]] Equilibrium assemble(const Problem& problem,
                                   const std::vector<const PlacedSpan*>& placed,
                                   const std::vector<const SpanSolution*>& solutions);

}  // namespace dlo::energy_model
