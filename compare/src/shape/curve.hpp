#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/alignment.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {

/// A reference shape as cubic pieces between equally spaced arc lengths, for many quick searches of
/// nearest points. It is off by h^4/384 of the fourth derivative: 2e-9 of the length for a rod with
/// Gamma = 100.
class Curve {
 public:
  /// @param length  of the rod [m]; the pieces go from arc length 0 to it
  Curve(const Reference& reference, double length);

  [[nodiscard]] double length() const { return length_; }
  /// 0 <= s <= length [m].
  [[nodiscard]] Eigen::Vector3d point(double s) const { return at(s).point; }
  [[nodiscard]] Eigen::Vector3d tangent(double s) const { return at(s).tangent; }
  [[nodiscard]] Eigen::Matrix3Xd points(const std::vector<double>& s) const;

  /// Arc length, near `s`, of the curve's point nearest to a position [m].
  [[nodiscard]] double nearest(const Eigen::Vector3d& position, double s) const;

  /// Arc lengths that grow with the index and make the sum of squared distances least: the best of
  /// all choices of nodes (dynamic programming), each then moved to the nearest point close by.
  /// @param positions  [m], 3 x M
  [[nodiscard]] std::vector<double> nearest_in_order(const Eigen::Matrix3Xd& positions) const;

 private:
  struct Local {
    Eigen::Vector3d point, tangent, second;  // and derivatives by arc length
  };
  [[nodiscard]] Local at(double s) const;

  double length_;
  double step_;
  Eigen::Matrix3Xd nodes_;
  Eigen::Matrix3Xd tangents_;
};

/// The rule that `automatic` stands for; any other as it is.
[[nodiscard]] ArcLengths arc_length_rule(const MeasuredShape& shape, ArcLengths asked);

/// The file's own, within the rod [m]. @throws InputError if it has none, or they leave the rod
[[nodiscard]] std::vector<double> file_arc_lengths(const MeasuredShape& shape, double length);

/// Sum of the chords [m]. @param points  [m], 3 x M, M >= 1
[[nodiscard]] double polyline_length(const Eigen::Matrix3Xd& points);

/// Lengths along a curve through the points [m]: each chord d with the mean curvature k at its ends
/// is an arc of d (1 + (k d)^2 / 24).
[[nodiscard]] std::vector<double> lengths_along(const Eigen::Matrix3Xd& points);

/// Lays a shape in the scene's frame along the rod by what the grippers say, as a guess of the
/// rod's shape that needs no equilibrium: at the file's arc lengths, or at lengths along the
/// polyline, which are scaled to the rod where they are as long to 3 %. Of a shorter polyline where
/// it begins, and of every file from which end, is chosen so that the points come nearest to the
/// grippers.
/// @param rule  as of arc_length_rule()
/// @return its points by growing arc length, those too many left out that share one
/// @throws InputError as file_arc_lengths()
[[nodiscard]] Shape laid_by_grippers(const MeasuredShape& shape, const Scene& scene,
                                     ArcLengths rule);

/// Whether points at equal distances are shorter than a rod by one of their segments, to a tenth of
/// it: where each body of a chain begins, without the end of the last.
[[nodiscard]] bool lacks_one_segment(const Eigen::Matrix3Xd& points, double length);

}  // namespace dlo::compare
