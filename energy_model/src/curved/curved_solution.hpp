#pragma once

#include <vector>

#include "base/deadline.hpp"
#include "dlo/energy_model/exact.hpp"

namespace dlo::energy_model {

/// Equilibria of a rod that has_material_directors(), stable ones first, by energy; never empty.
struct CurvedSolutions {
  std::vector<Equilibrium> equilibria;
  bool out_of_time = false;
};

/// From `start` or by a search (curved_search.hpp).
[[nodiscard]] CurvedSolutions solve_curved(const Problem& problem, const ExactOptions& options,
                                           const Deadline& deadline);

}  // namespace dlo::energy_model
