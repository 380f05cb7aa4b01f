#pragma once

#include "base/deadline.hpp"
#include "dlo/energy_model/exact.hpp"

namespace dlo::energy_model {

/// An equilibrium of a rod some of whose loads have no potential: that which the lowest one under
/// the others goes over into as these grow from nothing, or that which Newton's method leads to
/// from the options' start. `not_verified`: without an energy nothing says whether it is stable.
/// @throws std::invalid_argument as solve_exact(), or if there are obstacles, a load follows the
/// rod at a clamp, or more than two clamps hold frames
[[nodiscard]] Equilibrium solve_without_potential(const Problem& problem,
                                                  const ExactOptions& options,
                                                  const Deadline& deadline);

}  // namespace dlo::energy_model
