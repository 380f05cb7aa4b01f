#pragma once

#include <optional>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

struct OrderedGrip {
  std::size_t index;  ///< index in Problem::grips
  const Grip* grip;   ///< grip of the problem, which has to outlive this
};

/// Returns the grips by growing arc length.
/// @throws std::invalid_argument if two are at one arc length, or as far apart as the rod between
/// them is long or farther, unless the rod stretches
[[nodiscard]] std::vector<OrderedGrip> ordered_grips(const Problem& problem);

/// Returns the index in Problem::grips of the clamp that alone carries a load, because they are
/// within 1e-9 l of each other. Every other load is carried by exactly one span, so that each
/// counts once.
[[nodiscard]] std::optional<std::size_t> clamp_under(const Problem& problem, const Load& load);

/// Adds the loads on clamps to the clamps' reactions, and their potential relative to the first
/// grip to the energy, because no span carries them.
void add_loads_on_clamps(const Problem& problem, Equilibrium& result);

}  // namespace dlo::energy_model
