#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"

namespace dlo::compare {

/// Of the hinges of a chain.
enum class Springs {
  as_the_rod,  ///< EI/h
  fitted,      ///< that fit best
};

/// A chain of hinges in a scene, whose points a file may have.
struct OwnPolygon {
  ChainClamp clamp = ChainClamp::hinge;
  double rms_m = 0;      ///< of the file's points from it
  double max_m = 0;      ///< the largest of those
  double stiffness = 1;  ///< of its springs, over EI/h
};

/// The words for a chain.
[[nodiscard]] std::string words_of(ChainClamp clamp, Eigen::Index segments);

/// The chains that have as many hinges as a file has points, each at rest in the scene with a
/// spring in each hinge: with a hinge at the clamp, with its first segment welded to it, and with
/// the clamp in the middle of a segment, where the file's first segment is half a one. None where
/// grippers are between the file's points or the scene has what a plain chain has not.
/// @param shape  in the scene's frame, along the whole rod
[[nodiscard]] std::vector<OwnPolygon> own_polygons(const Scene& scene, const Shape& shape,
                                                   Springs springs);

}  // namespace dlo::compare
