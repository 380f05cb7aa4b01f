#pragma once

#include <optional>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

struct OrderedGrip {
  std::size_t index;  ///< in Problem::grips
  const Grip* grip;   ///< of the problem, which has to outlive it
};

/// The grips by growing arc length.
/// @throws std::invalid_argument if two are at one arc length, or further apart than the rod
/// between them, which does not stretch
[[nodiscard]] std::vector<OrderedGrip> ordered_grips(const Problem& problem);

/// The clamp that carries a load alone, because they are within 1e-9 l of each other: its index in
/// Problem::grips. Every other load is carried by exactly one span, so that each counts once.
[[nodiscard]] std::optional<std::size_t> clamp_under(const Problem& problem, const Load& load);

/// Adds the loads on clamps to the clamps' reactions, and their potential from the first grip on to
/// the energy: no span carries them.
void add_loads_on_clamps(const Problem& problem, Equilibrium& result);

}  // namespace dlo::energy_model
