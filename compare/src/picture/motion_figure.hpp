#pragma once

#include "figure/layout.hpp"
#include "figure/series.hpp"
#include "recording/motion_check.hpp"

namespace dlo::compare {

/// The frame of a recording that is the farthest from the rod, where grippers and obstacles are
/// then; where the recording is late or early, also the rod at the time that it shows.
[[nodiscard]] Drawing worst_frame_drawing(const MotionCheck& check);

/// That frame, and beside it the distance of each frame from the rod against time, the worst one
/// circled, and what is left of it without a lag.
[[nodiscard]] Picture motion_check_picture(const MotionCheck& check);

}  // namespace dlo::compare
