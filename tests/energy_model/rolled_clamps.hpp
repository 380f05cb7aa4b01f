#pragma once

#include "../helpers.hpp"
#include "problems.hpp"

namespace dlo::test {

/// Returns a horizontal rod of unit length and stiffness whose clamps hold its frame, at the
/// distance `span`, with a roll of the second clamp.
inline energy_model::Problem framed_clamps(double gamma, double span, double torsional_stiffness,
                                           double roll) {
  energy_model::Problem problem = two_clamps(gamma, span);
  problem.torsional_stiffness = torsional_stiffness;
  for (energy_model::Grip& grip : problem.grips) grip.frame = energy_model::FrameHold{};
  problem.grips[1].frame->roll = roll;
  return problem;
}

/// Returns a rod without weight between two clamps that hold frames. The second clamp has the given
/// position, direction and roll.
inline energy_model::Problem rolled_clamps(const Eigen::Vector3d& end,
                                           const Eigen::Vector3d& direction,
                                           double torsional_stiffness, double roll) {
  energy_model::Problem problem = framed_clamps(0, 0.5, torsional_stiffness, roll);
  problem.grips[1].position = end;
  problem.grips[1].direction = direction;
  return problem;
}

}  // namespace dlo::test
