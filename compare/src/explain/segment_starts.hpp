#pragma once

#include "dlo/compare/alignment.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {

/// Completes a shape whose points are the start points of a chain's segments, as MuJoCo's xpos are,
/// by the end of the last segment; returns any other shape unchanged. The end is the position of
/// the gripper that holds it. The last segment of a free end is rotated by a quarter of the
/// rotation of the segment before, since the moment of a weight grows with the square of the
/// distance. Points are start points if they have no arc lengths, N > 3 of them are l/N apart
/// within 2 %, a gripper of an end of the rod holds the first one and none the last one, and, if
/// grippers hold both ends, one of s = l is one segment away from the last point. Points of a
/// simulator's model need not be held, N > 2 suffices, and of all bodies of the model those of the
/// chain are used. Notes state what was done; directors are removed.
/// @param pose  unknown coordinates of the shape's frame; if it is not the scene's frame, only
/// points of a model are completed
[[nodiscard]] MeasuredShape complete_segment_starts(const Scene& scene, const MeasuredShape& shape,
                                                    PoseFreedom pose = PoseFreedom::known);

}  // namespace dlo::compare
