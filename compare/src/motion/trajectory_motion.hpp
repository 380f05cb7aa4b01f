#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "dlo/compare/trajectory.hpp"
#include "dlo/energy_model/grip_motion.hpp"

namespace dlo::compare {

/// Returns a gripper's trajectory as a motion of the energy model, whose time is zero at `begin`
/// [s]. Its rotation is relative to the pose at `begin`, along great circles and with the rolls.
/// Accelerations jump at poses. At a pose, up to rounding of the time, they are those before it;
/// just after it, they are those after it.
/// @param way          trajectory with poses
/// @param rolls_about  direction at `begin` of a clamp that holds the rod's frame; empty for
/// others, whose rolls have no effect
[[nodiscard]] energy_model::GripMotion trajectory_motion(
    const Trajectory& way, double begin,
    const std::optional<Eigen::Vector3d>& rolls_about = std::nullopt);

/// Returns the times of the poses relative to `begin` [s]: MovingRod::breaks.
[[nodiscard]] std::vector<double> trajectory_breaks(const Trajectory& way, double begin);

}  // namespace dlo::compare
