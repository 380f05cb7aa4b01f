#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace dlo::compare {

/// Axes that a file may have instead of the scene's.
struct FileAxes {
  Eigen::Matrix3d axes;  ///< from the file's coordinates to the scene's: signed permutation
  std::string words;     ///< a clause: "z is up in the file (the scene's y is the file's z, ..)"
};

/// Returns all axes with which the points differ from those in the scene's axes and in any axes
/// listed before, by more than 1e-9 of their extent. Those with the fewest changes come first, and
/// among exchanged axes proper rotations come before mirror images.
/// @param points  in the file's axes, 3 x M
[[nodiscard]] std::vector<FileAxes> other_axes(const Eigen::Vector3d& gravity,
                                               const Eigen::Matrix3Xd& points);

/// Returns the transformation from the axes of a picture to the scene's.
/// @param up  1 if the picture's y points up, -1 if it points down
[[nodiscard]] Eigen::Matrix3d picture_axes(const Eigen::Vector3d& gravity, double up);

}  // namespace dlo::compare
