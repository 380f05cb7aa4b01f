#pragma once

#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Judges an equilibrium that touches rigid walls by what is returned: measures its penetration on
/// a grid much finer than the solver's nodes, and takes a success back (`not_resolved`) if the
/// shape is deeper than `allowed_penetration` lengths behind a wall or if the contact forces that
/// hold it have not settled. Soft walls are entered by as much as they push: nothing to prove.
/// @param[in,out] equilibrium  status, message and penetration
void judge_contact(const Problem& problem, const std::vector<const SpanSolution*>& spans,
                   Equilibrium& equilibrium);

}  // namespace dlo::energy_model
