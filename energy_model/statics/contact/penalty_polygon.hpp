#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/deadline.hpp"
#include "frames/span_shape.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

/// A coarse polygon at rest on a span's obstacles, which tells what touches what.
struct PenaltyPolygon {
  bool at_rest = false;
  double energy = 0;  ///< in EI/l
  int evaluations = 0;
  std::vector<double> s;      ///< of its points, by growing s
  Eigen::Matrix3Xd points;    ///< 3 x s
  Eigen::VectorXd middles;    ///< s of the segments' middles
  Eigen::Matrix3Xd tangents;  ///< of the segments, unit, 3 x middles
  std::vector<Span::Contact> contacts;
  double twist = 0;  ///< of a round rod whose ends' frames are held [rad]

  /// Its tangents, to start from.
  [[nodiscard]] TangentField field() const;
};

/// How many segments a polygon has.
enum class Segments {
  few,  ///< a third of those that contacts take, which tell for less where it leads
  all,
};

/// How a polygon goes downhill.
enum class Descent {
  far,   ///< in large steps, with soft segments at first: quick, and to any minimum
  near,  ///< in small steps with stiff segments: to the minimum next to the start
};

/// Descends from a shape with points that the obstacles push back by stiff springs, and stretch
/// that is small: right to about the square of a segment. Where the shape goes through the inside
/// of a block, which would push it out of several faces at once, the block grows out of a ball.
[[nodiscard]] PenaltyPolygon rest_on_obstacles(const Span& span, const TangentField& start,
                                               Segments segments, const Deadline& deadline,
                                               Descent descent = Descent::far);

/// The same with all segments, from where one of few rests.
[[nodiscard]] PenaltyPolygon rest_refined(const Span& span, const PenaltyPolygon& coarse,
                                          const Deadline& deadline, Descent descent = Descent::far);

}  // namespace dlo::energy_model
