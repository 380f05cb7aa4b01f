#pragma once

#include "base/deadline.hpp"
#include "dlo/energy_model/exact.hpp"

namespace dlo::energy_model {

/// Returns an equilibrium of a rod with loads that have no potential. It is the continuation of the
/// lowest equilibrium under the other loads as these loads grow from zero, or the one to which
/// Newton's method converges from the options' start. It is `not_verified`, because without an
/// energy its stability is undetermined.
/// @throws std::invalid_argument as solve_exact(), or if there are obstacles, a load follows the
/// rod at a clamp, or more than two clamps hold frames of a round straight rod
[[nodiscard]] Equilibrium solve_without_potential(const Problem& problem,
                                                  const ExactOptions& options,
                                                  const Deadline& deadline);

}  // namespace dlo::energy_model
