#pragma once

#include "dlo/compare/alignment.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {

/// Returns a shape whose points are where the segments of a chain begin, as MuJoCo's xpos are, with
/// the end of its last segment; any other shape as it is. That end is where a gripper holds it. A
/// free end's last segment is rotated by a quarter of the rotation of the segment before, as the
/// moment of a weight grows with the square of the distance. Points are such begins if they have no
/// arc lengths, N of them are l/N apart within 2 %, and the first one is held at an end of the rod;
/// those of a simulator's model need not be held, and of all bodies of the model those of the chain
/// are taken. Notes state what was done.
/// @param pose  what is unknown of the shape's frame; unless that is the scene's, only the points
/// of
///              a model are completed
[[nodiscard]] MeasuredShape whole_of_segment_starts(const Scene& scene, const MeasuredShape& shape,
                                                    PoseFreedom pose = PoseFreedom::known);

}  // namespace dlo::compare
