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

/// All with which the points are others than in the scene's axes and than in any listed before, to
/// 1e-9 of their extent: those with the fewest changes first, of exchanged ones proper rotations
/// before mirror images.
/// @param points  in the file's axes, 3 x M
[[nodiscard]] std::vector<FileAxes> other_axes(const Eigen::Vector3d& gravity,
                                               const Eigen::Matrix3Xd& points);

/// The scene's axes as those of a picture, in which y is up (1) or down (-1).
[[nodiscard]] Eigen::Matrix3d picture_axes(const Eigen::Vector3d& gravity, double up);

}  // namespace dlo::compare
