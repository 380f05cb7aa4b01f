#pragma once

#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// The energy model's shape on obstacles where its own search finds none, since its starts know no
/// obstacle: from the rest shape of a Hookean polygon, which has found its way around them.
/// @return converged or not
/// @throws InputError, ConvergenceError of the polygon, std::invalid_argument
[[nodiscard]] energy_model::Equilibrium solve_from_chain(const Scene& scene,
                                                         const SolveOptions& options);

}  // namespace dlo::compare
