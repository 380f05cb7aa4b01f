#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace dlo::compare {

/// Shapes of a rod at equal steps of time and of arc length, interpolated by cubics (Lagrange's,
/// through the four nearest values) in both. Before the first and after the last frame the shape is
/// constant.
class ModelMotion {
 public:
  /// @param begin, end  times of the first and the last frame [s]
  /// @param length      of the rod, on which the points have equal distances [m]
  /// @param frames      points [m], 3 x M each; M and the number of frames are at least four
  ModelMotion(double begin, double end, double length, std::vector<Eigen::Matrix3Xd> frames);

  [[nodiscard]] double begin() const { return begin_; }  ///< [s]
  [[nodiscard]] double end() const { return end_; }      ///< [s]
  /// Returns the rod's point at a time and an arc length [m].
  [[nodiscard]] Eigen::Vector3d at(double time, double arc_length) const;

 private:
  double begin_, end_, length_;
  std::vector<Eigen::Matrix3Xd> frames_;
};

}  // namespace dlo::compare
