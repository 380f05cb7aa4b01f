#pragma once

#include <optional>

#include "dlo/compare/shape.hpp"
#include "recording/model_motion.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {

/// One frame of a recording and the rod at that time.
struct FrameShapes {
  double time = 0;                         ///< [s]
  Shape recorded;                          ///< the frame's points
  Shape on_rod;                            ///< the rod's points at the same arc lengths
  Shape rod;                               ///< the whole rod
  std::optional<Shape> rod_at_other_time;  ///< the whole rod at time - lag, if there is a lag
};

/// Returns a frame of a recording with the rod. @param time    of a frame of the recording [s]
/// @param length  of the rod [m]
/// @param lag     delay of the recording [s]; NaN: none
[[nodiscard]] FrameShapes frame_shapes(const MarkerMotion& recorded, const ModelMotion& model,
                                       double time, double length, double lag);

}  // namespace dlo::compare
