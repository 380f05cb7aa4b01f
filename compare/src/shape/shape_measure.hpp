#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/alignment.hpp"
#include "dlo/compare/deviation.hpp"

namespace dlo::compare {

/// How much each point of a polyline on a rod counts, together 1: half of both its segments, each
/// by the longer of the rod's arc length and the polyline's own. So neither a part of the rod that
/// the points cut short nor points that leave the rod go uncounted. Up to a percent of stretch is
/// the polyline's own affair: the weights are then the trapezoidal rule's over the arc length.
/// @param s  rod arc length of each point, growing [m], M >= 2;  @param points  [m], 3 x M
[[nodiscard]] Eigen::VectorXd point_weights(const std::vector<double>& s,
                                            const Eigen::Matrix3Xd& points);

/// Every point of a laid shape against the rod.
struct Measured {
  std::vector<double> arc_length;  ///< of the rod where each point is held against it [m], M
  Eigen::Matrix3Xd reference;      ///< the rod there [m], 3 x M
  double excess_at_start_m = 0;    ///< by which the points go on past arc length 0 [m]
  double excess_at_end_m = 0;      ///< and past l
  double rms_m = 0;                ///< with point_weights [m]
  double max_m = 0;                ///< of all points, never below the RMS [m]
  Eigen::Index worst = 0;          ///< where that is
};

/// Distances of a laid shape's points from the rod: at their arc lengths if those are given. For
/// `nearest` at the points laid on; if points go on past an end of the rod, the file is longer than
/// the rod, and the excess is spread evenly: arc lengths are scaled until the outermost point is
/// the rod's end. The excess is how far from the end points get, but no more than what the polyline
/// is longer than the rod that it covers: another shape of the right length has none.
[[nodiscard]] Measured measure(const Alignment& alignment, const Reference& reference,
                               double length);

/// Distances of a file as the whole rod.
struct WholeRod {
  double rms_m = 0;
  double max_m = 0;
};

/// What is missing of the rod at an end counts with its distance from the outermost point.
[[nodiscard]] WholeRod whole_of(const Measured& measured, const Alignment& alignment,
                                const Reference& reference, double length);

/// Parts of the rod between neighbouring points, those longer than 1e-3 l, and how well points
/// there tell the rod between: the reference at the middle against the cubic through the
/// reference at the four points around (fewer at the ends; none that are nearer to the gap than
/// a tenth of it).
[[nodiscard]] std::vector<RodPart> parts_between(const std::vector<double>& s,
                                                 const Reference& reference, double length);

}  // namespace dlo::compare
