#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Characters that a sketch is made of.
enum class SketchMarks {
  braille,  ///< two by four dots a character, U+2800 to U+28FF
  ascii,    ///< one by two: " ", "'", "." and ":"
};

/// Points joined by straight lines; the others are dots of their own.
struct SketchLine {
  Eigen::Matrix2Xd points;  ///< to the right and up, 2 x M
  bool joined = true;       ///< by lines
};

/// Lines in a box of characters, one text line each without blanks at its end, ended by "\n". Equal
/// aspect: a character is taken as twice as high as wide, and all lines have one scale, as large as
/// the box allows. What has no extent in one direction is one character high or wide.
/// @param lines  finite, at least one point in all;  @param columns, rows  of the box, >= 1
[[nodiscard]] std::string sketch(const std::vector<SketchLine>& lines, int columns, int rows,
                                 SketchMarks marks);

/// The same in space.
struct SpatialLine {
  Eigen::Matrix3Xd points;  ///< [m], 3 x M
  bool joined = true;       ///< by lines
};

/// Lines in space in the plane of the scene, or in the projection with gravity upright (views_of),
/// under a line that names the axes and the scale.
[[nodiscard]] std::string sketch_of(const Scene& scene, const std::vector<SpatialLine>& lines,
                                    int columns, int rows, SketchMarks marks);

}  // namespace dlo::compare
