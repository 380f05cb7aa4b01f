#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "dlo/compare/alignment.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Returns the weights of the points of a polyline on a rod, with sum 1: half the length of both
/// adjacent segments. The length of a segment is the rod's arc length or the polyline's own length
/// divided by 1.01, whichever is larger. So both parts of the rod that the points cut short and
/// points that leave the rod are counted. For an axial strain of the polyline up to 1 % the weights
/// are those of the trapezoidal rule over the arc length.
/// @param s  rod arc length of each point, growing [m], M >= 2;  @param points  [m], 3 x M
[[nodiscard]] Eigen::VectorXd point_weights(const std::vector<double>& s,
                                            const Eigen::Matrix3Xd& points);

/// Distances of the points of an aligned shape from the rod.
struct Measured {
  std::vector<double> arc_length;  ///< arc length with which each point is compared [m], M
  Eigen::Matrix3Xd reference;      ///< points of the rod at these arc lengths [m], 3 x M
  double excess_at_start_m = 0;    ///< length by which the points extend past arc length 0 [m]
  double excess_at_end_m = 0;      ///< length by which they extend past arc length l [m]
  double rms_m = 0;                ///< RMS distance with point_weights [m]
  double max_m = 0;                ///< largest distance of all points, never below the RMS [m]
  Eigen::Index worst = 0;          ///< index of the point with the largest distance
};

/// Computes the distances of an aligned shape's points from the rod at their arc lengths. With
/// `nearest`, points that extend past an end of the rod mean that the file is longer than the rod.
/// The excess is then spread evenly: arc lengths are scaled until the outermost point is at the
/// rod's end. The excess is the distance that points reach from the end, limited to the difference
/// between the polyline and the part of the rod that it covers: a different shape of the right
/// length has no excess.
[[nodiscard]] Measured measure(const Alignment& alignment, const Reference& reference,
                               double length);

/// Distances between a file and the whole rod [m].
struct WholeRod {
  double rms_m = 0;
  double max_m = 0;
};

/// Computes the distances between a file and the whole rod. A part of the rod that the file lacks
/// at an end is compared with the outermost point.
[[nodiscard]] WholeRod whole_rod_distances(const Measured& measured, const Alignment& alignment,
                                           const Reference& reference, double length);

/// Returns the index of the point at the end of the rod that no gripper holds, std::nullopt if the
/// points do not reach such an end; if they reach two, that at arc length l.
/// @param s  arc lengths of the points [m]
[[nodiscard]] std::optional<Eigen::Index> free_tip(const Scene& scene,
                                                   const std::vector<double>& s);

/// Returns the intervals of the rod between neighbouring points that are longer than 1e-3 l, with
/// the interpolation error of each: the distance between the reference at the middle and the cubic
/// through the reference at the four points around. Fewer points are used at the ends, and none
/// that is nearer to the interval than a tenth of its length.
[[nodiscard]] std::vector<RodPart> intervals_between_points(const std::vector<double>& s,
                                                            const Reference& reference,
                                                            double length);

}  // namespace dlo::compare
