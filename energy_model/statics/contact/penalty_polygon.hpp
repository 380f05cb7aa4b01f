#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "base/deadline.hpp"
#include "frames/span_shape.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

/// Returns a polygon's tangent at s: between the middles of two segments the weighted sum of their
/// tangents, normalised; beyond the outermost middles the tangent of that segment.
/// @param middles  arc lengths, ascending;  @param tangents  of the segments, unit, 3 x middles
[[nodiscard]] inline Eigen::Vector3d tangent_between(const Eigen::VectorXd& middles,
                                                     const Eigen::Matrix3Xd& tangents, double s) {
  const Eigen::Index last = middles.size() - 1;
  const double* const after = std::lower_bound(middles.data(), middles.data() + last, s);
  const Eigen::Index i = std::max<Eigen::Index>(1, after - middles.data());
  if (last == 0) return tangents.col(0);
  const double share = std::clamp((s - middles[i - 1]) / (middles[i] - middles[i - 1]), 0.0, 1.0);
  const Eigen::Vector3d t = (1 - share) * tangents.col(i - 1) + share * tangents.col(i);
  return t.norm() > 1e-3 ? t.normalized() : Eigen::Vector3d(tangents.col(i));
}

/// A coarse polygon in equilibrium on a span's obstacles, which determines the initial contacts.
struct PenaltyPolygon {
  bool at_rest = false;
  double energy = 0;  ///< [EI/l]
  int evaluations = 0;
  std::vector<double> s;      ///< arc lengths of its points, ascending
  Eigen::Matrix3Xd points;    ///< one column per point of s
  Eigen::VectorXd middles;    ///< arc lengths of the segments' middles
  Eigen::Matrix3Xd tangents;  ///< unit tangents of the segments, 3 x middles
  std::vector<Span::Contact> contacts;
  double twist = 0;  ///< twist angle of a round rod with prescribed end frames [rad]

  /// Returns its tangents as an initial guess.
  [[nodiscard]] TangentField field() const;
};

/// Number of segments of a polygon.
enum class Segments {
  few,  ///< a third of those that contacts need; cheaper, shows which minimum is reached
  all,
};

/// Descent strategy of a polygon.
enum class Descent {
  far,   ///< large steps, from a shape with soft segments at first: fast, may reach any minimum
  near,  ///< small steps with stiff segments: reaches the minimum near the start
};

/// Minimises from a shape the energy of a polygon whose points the obstacles push out by stiff
/// springs and whose stretch is small. The error is about the square of a segment. If the shape
/// passes through the core of a block, which would push it out of several faces at once, each rigid
/// body is replaced by a ball that changes into the body in stages.
[[nodiscard]] PenaltyPolygon relax_on_obstacles(const Span& span, const TangentField& start,
                                                Segments segments, const Deadline& deadline,
                                                Descent descent = Descent::far);

/// Minimises with all segments, starting from a polygon with few segments in equilibrium.
[[nodiscard]] PenaltyPolygon relax_refined(const Span& span, const PenaltyPolygon& coarse,
                                           const Deadline& deadline,
                                           Descent descent = Descent::far);

/// Returns copies of the span with pins next to its obstacles, so that shapes through the pins pass
/// an obstacle on either side: first single obstacles, nearest to the anchor first, then pairs; at
/// most ten copies. Between two grips such a shape continues to the second grip; beyond the
/// outermost grip the rod hangs from the obstacle. There is no copy for half-spaces, for obstacles
/// that the rod is too short to pass, and for paths with a pin within a rigid obstacle.
[[nodiscard]] std::vector<Span> pinned_past_obstacles(const Span& span);

}  // namespace dlo::energy_model
