#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/alignment.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {

/// A reference shape as cubic polynomials between equally spaced arc lengths, for many fast
/// searches of nearest points. Its error is h^4/384 times the fourth derivative, for spacing h:
/// 2e-9 of the length for a rod with Gamma = 100.
class Curve {
 public:
  /// @param length  of the rod [m]; the curve covers arc lengths from 0 to `length`
  Curve(const Reference& reference, double length);

  [[nodiscard]] double length() const { return length_; }
  /// Returns the point at an arc length [m]. @param s  0 <= s <= length [m]
  [[nodiscard]] Eigen::Vector3d point(double s) const { return at(s).point; }
  [[nodiscard]] Eigen::Vector3d tangent(double s) const { return at(s).tangent; }
  [[nodiscard]] Eigen::Matrix3Xd points(const std::vector<double>& s) const;

  /// Returns the arc length, near `s`, of the curve's point that is nearest to a position [m].
  [[nodiscard]] double nearest(const Eigen::Vector3d& position, double s) const;

  /// Returns arc lengths in order that minimise the sum of squared distances. Dynamic programming
  /// finds the best non-decreasing nodes; each arc length then moves to the nearest point within
  /// one spacing, so that neighbours may exchange their order by up to two spacings.
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

/// Returns the rule that `automatic` stands for; returns any other rule unchanged.
[[nodiscard]] ArcLengths arc_length_rule(const MeasuredShape& shape, ArcLengths asked);

/// Returns the points by growing arc length, with the arc lengths of the file, limited to the rod.
/// @throws InputError if the file has none, or if one is not on the rod
[[nodiscard]] Shape shape_of_file(const MeasuredShape& shape, double length);

/// Returns the sum of the chords [m]. @param points  [m], 3 x M, M >= 1
[[nodiscard]] double polyline_length(const Eigen::Matrix3Xd& points);

/// Returns the distances between neighbouring points [m], one fewer than there are points.
[[nodiscard]] Eigen::VectorXd chord_lengths(const Eigen::Matrix3Xd& points);

/// Returns lengths along a curve through the points [m]. A chord d with the mean curvature k of its
/// ends is replaced by an arc of length d (1 + (k d)^2 / 24).
[[nodiscard]] std::vector<double> arc_lengths_along(const Eigen::Matrix3Xd& points);

/// Assigns arc lengths to a shape in the scene's frame by means of the grippers. The result is a
/// guess of the rod's shape that needs no equilibrium. Arc lengths are those of the file, or
/// lengths along the polyline. These are scaled to the rod by `chord`, and by `nearest` if they are
/// longer than the rod or at most 3 % shorter. The direction of the file, and the position of a
/// shorter polyline along the rod, are chosen so that the points are nearest to the grippers.
/// @param rule  result of arc_length_rule()
/// @return the points by strictly growing arc length; only the first of several with one arc length
/// is kept
/// @throws InputError in the cases of shape_of_file()
[[nodiscard]] Shape aligned_by_grippers(const MeasuredShape& shape, const Scene& scene,
                                        ArcLengths rule);

/// Whether points at equal distances are shorter than a rod by one of their segments, to a tenth of
/// it. This is the case if the points are the start points of a chain's bodies, without the end of
/// the last body.
[[nodiscard]] bool lacks_one_segment(const Eigen::Matrix3Xd& points, double length);

}  // namespace dlo::compare
