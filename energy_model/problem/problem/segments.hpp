#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "problem/span.hpp"

namespace dlo::energy_model {

/// Part of a span between neighbouring grips, in the span's units.
struct Segment {
  double begin = 0, end = 0;  ///< arc lengths
  Eigen::Vector3d chord = Eigen::Vector3d::Zero();
  /// Direction of the force that stretches the segment: that of the chord, corrected by the
  /// sideways displacement of the layers at its ends.
  Eigen::Vector3d pull = Eigen::Vector3d::UnitX();
  /// Directions of clamps within the span.
  std::optional<Eigen::Vector3d> begin_direction, end_direction;
  /// Unit tangents at the ends, exact or estimated: the direction of a clamp; at a pin between two
  /// segments a direction between their pulls; at other pins the pull.
  Eigen::Vector3d begin_tangent = Eigen::Vector3d::UnitX();
  Eigen::Vector3d end_tangent = Eigen::Vector3d::UnitX();
  /// Tension T with which the segment takes up its slack, 0 if the slack is large. A layer in which
  /// the rod rotates by phi from its end to the pull takes 2 (1 - cos(phi/2)) T^(-1/2) of the
  /// slack, and displaces the rod sideways by 2 sin(phi/2) T^(-1/2). The sag under a force P across
  /// the chord at x takes P^2 x (L - x) / (2 L T^2), that under a weight w across it w^2 L^3 / (24
  /// T^2).
  double tension = 0;

  [[nodiscard]] double length() const { return end - begin; }
  [[nodiscard]] double slack() const { return length() - chord.norm(); }
  /// Whether the segment is straight except in the layers at its ends.
  [[nodiscard]] bool taut() const { return tension * length() * length() > 100; }
};

/// Returns the segments between all grips of a span, by growing s.
[[nodiscard]] std::vector<Segment> segments_of(const Span& span);

}  // namespace dlo::energy_model
