#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "problem/span.hpp"

namespace dlo::energy_model {

/// The part of a span between neighbouring grips, own units.
struct Segment {
  double begin = 0, end = 0;  ///< arc lengths
  Eigen::Vector3d chord = Eigen::Vector3d::Zero();
  /// Of the force that stretches it; the chord's, but for what the layers at its ends take aside.
  Eigen::Vector3d pull = Eigen::Vector3d::UnitX();
  std::optional<Eigen::Vector3d> begin_direction, end_direction;  ///< of clamps inside the span
  /// Unit tangents that its ends have, or about have: a clamp's direction, at a pin between two
  /// segments one between their pulls, at other pins the pull.
  Eigen::Vector3d begin_tangent = Eigen::Vector3d::UnitX();
  Eigen::Vector3d end_tangent = Eigen::Vector3d::UnitX();
  /// Tension T that takes up what little slack there is, 0 where there is much. A layer in which
  /// the rod turns from its end to the pull by phi takes 2 (1 - cos(phi/2)) T^(-1/2) of it, and as
  /// much aside as 2 sin(phi/2) T^(-1/2); the sag under a force P across the chord at x takes
  /// P^2 x (L - x) / (2 L T^2), that under a weight w across it w^2 L^3 / (24 T^2).
  double tension = 0;

  [[nodiscard]] double length() const { return end - begin; }
  [[nodiscard]] double slack() const { return length() - chord.norm(); }
  /// Straight but for the layers at its ends.
  [[nodiscard]] bool taut() const { return tension * length() * length() > 100; }
};

/// Between all grips of a span, by growing s.
[[nodiscard]] std::vector<Segment> segments_of(const Span& span);

}  // namespace dlo::energy_model
