#pragma once

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {

/// A shape as the whole rod where it is the places of the bodies of the scene's model, each of
/// which is where a segment begins, as MuJoCo's xpos: with the end of the last segment. That is
/// where a gripper holds it; a free end's last segment is rotated on by a quarter of what the one
/// before is, as the moment of a weight grows with the square of the distance. Of all bodies of the
/// model those of the chain are taken. Any other shape as it is. Notes say what was done.
[[nodiscard]] MeasuredShape whole_of_segment_starts(const Scene& scene, const MeasuredShape& shape);

}  // namespace dlo::compare
