#pragma once

#include <vector>

#include "dlo/compare/scene.hpp"
#include "motion/track.hpp"
#include "recording/motion_check.hpp"
#include "recording/motion_residuals.hpp"

namespace dlo::compare {

/// Fits displacements of each gripper to a recording's residuals (least squares): the same
/// displacement at all times, and a displacement of each frame. The motion of the rod with a
/// gripper is computed from equilibrium shapes, by differences. The RMS with a displacement of each
/// frame is corrected for its three numbers per frame.
/// @param options    options of the track of the rod, with `from` and `to`
/// @param at_rest    the rod at rest with these options
/// @param residuals  as motion_residuals() [m]
/// @return both causes for each gripper; only the first one if frames have fewer than two points in
/// the mean, and none for a gripper that cannot be displaced
[[nodiscard]] std::vector<MotionCause> gripper_causes(const Scene& scene,
                                                      const TrackOptions& options,
                                                      const MarkerMotion& recorded,
                                                      const ModelMotion& at_rest,
                                                      const Eigen::Matrix3Xd& residuals);

}  // namespace dlo::compare
