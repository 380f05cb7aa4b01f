#pragma once

#include <vector>

#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

struct OrderedGrip {
  std::size_t index;  ///< in Problem::grips
  const Grip* grip;   ///< of the problem, which has to outlive it
};

/// The grips by growing arc length.
/// @throws std::invalid_argument if two are further apart than the rod between them, or at one arc
/// length
[[nodiscard]] std::vector<OrderedGrip> ordered_grips(const Problem& problem);

}  // namespace dlo::energy_model
