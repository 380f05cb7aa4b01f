#pragma once

#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "problem/split.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Assembles one solution of each span into an equilibrium of the rod, in space and SI units.
[[nodiscard]] Equilibrium assemble(const Problem& problem, const std::vector<PlacedSpan>& placed,
                                   const std::vector<const SpanSolution*>& solutions);

}  // namespace dlo::energy_model
