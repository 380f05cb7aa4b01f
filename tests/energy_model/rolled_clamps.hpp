#pragma once

#include "problems.hpp"

namespace dlo::test {

/// Returns a weightless rod of unit length and stiffness, clamped at both ends, with a roll of the
/// second clamp.
inline energy_model::Problem rolled_clamps(const Eigen::Vector3d& end,
                                           const Eigen::Vector3d& direction,
                                           double torsional_stiffness, double roll) {
  energy_model::Problem problem = two_clamps(0, 0.5);
  problem.torsional_stiffness = torsional_stiffness;
  problem.grips[1].position = end;
  problem.grips[1].direction = direction;
  problem.grips[0].frame = energy_model::FrameHold{};
  problem.grips[1].frame = energy_model::FrameHold{.d1 = std::nullopt, .roll = roll};
  return problem;
}

}  // namespace dlo::test
