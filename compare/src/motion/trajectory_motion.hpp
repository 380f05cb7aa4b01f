#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "dlo/compare/trajectory.hpp"
#include "dlo/energy_model/grip_motion.hpp"

namespace dlo::compare {

/// A gripper's trajectory as a motion of the energy model's, whose time is zero at `begin` [s]; its
/// turn is that from the pose at `begin`, along the great circles, and with the rolls.
/// Accelerations jump at poses, where they are those before, to rounding of the time: what is just
/// after it has those after.
/// @param way          with poses
/// @param rolls_about  direction at `begin` of a clamp that holds the rod's frame; none: what does
///                     not, whose rolls turn nothing
[[nodiscard]] energy_model::GripMotion trajectory_motion(
    const Trajectory& way, double begin,
    const std::optional<Eigen::Vector3d>& rolls_about = std::nullopt);

/// The times of these poses [s], the same way: MovingRod::breaks.
[[nodiscard]] std::vector<double> trajectory_breaks(const Trajectory& way, double begin);

}  // namespace dlo::compare
