#pragma once

#include <vector>

#include "dlo/compare/scene.hpp"
#include "motion/track.hpp"
#include "recording/model_motion.hpp"
#include "recording/motion_check.hpp"

namespace dlo::compare {

/// What a gripper that is elsewhere leaves of a recording's residuals: displaced by the same vector
/// all the time, or by one of each frame's own (least squares). How the rod follows it is that of
/// shapes at rest, by differences. The RMS of one of each frame's own is corrected for its three
/// numbers a frame.
/// @param options    of the track that the rod was made with
/// @param at_rest    the rod at rest by these options
/// @param residuals  as motion_residuals() [m]
/// @return both for each gripper; none of a gripper that cannot be displaced
[[nodiscard]] std::vector<MotionCause> gripper_causes(const Scene& scene,
                                                      const TrackOptions& options,
                                                      const MarkerMotion& recorded,
                                                      const ModelMotion& at_rest,
                                                      const Eigen::Matrix3Xd& residuals);

}  // namespace dlo::compare
