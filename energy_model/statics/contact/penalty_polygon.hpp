#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/deadline.hpp"
#include "frames/span_shape.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

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
  far,   ///< large steps, with soft segments at first: fast, may reach any minimum
  near,  ///< small steps with stiff segments: reaches the minimum near the start
};

/// Minimises from a shape the energy of a polygon whose points the obstacles push out by stiff
/// springs and whose stretch is small. The error is about the square of a segment. If the shape
/// passes through the core of a block, which would push it out of several faces at once, the block
/// is replaced by a ball that changes into the block in stages.
[[nodiscard]] PenaltyPolygon rest_on_obstacles(const Span& span, const TangentField& start,
                                               Segments segments, const Deadline& deadline,
                                               Descent descent = Descent::far);

/// Minimises with all segments, starting from a polygon with few segments in equilibrium.
[[nodiscard]] PenaltyPolygon rest_refined(const Span& span, const PenaltyPolygon& coarse,
                                          const Deadline& deadline, Descent descent = Descent::far);

}  // namespace dlo::energy_model
