#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "dlo/energy_model/problem.hpp"
#include "dlo/energy_model/turns.hpp"
#include "problem/rod_law.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

/// Frames that the clamps at both ends of a span hold, in the span's frame.
struct HeldFrames {
  double stiffness = 0;              ///< harmonic mean of GJ, divided by EI
  Eigen::Vector3d start_d1, end_d1;  ///< first directors without roll
  HeldTurns turns;
};

/// A span and its position in the problem.
struct PlacedSpan {
  Span span;                         ///< the span, without twist
  std::optional<HeldFrames> frames;  ///< frames whose rotation twists the span
  /// Angle by which d1 of a rod with material directors is ahead of the span's [rad].
  double ahead = 0;
  bool reversed = false;                                ///< whether s decreases with the arc length
  double start = 0;                                     ///< arc length of s = 0 [m]
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();  ///< rows: the span's axes in space
  std::size_t anchor_grip = 0;
  std::vector<std::size_t> hold_grips;  ///< grips of span.holds in Problem::grips
  Eigen::Vector3d anchor_position = Eigen::Vector3d::Zero();  ///< position of anchor_grip [m]

  [[nodiscard]] double s_of(double arc_length, double length) const {
    return (reversed ? start - arc_length : arc_length - start) / length;
  }
};

/// Cuts a problem at its clamps, and converts every span to its units and its frame.
/// @throws std::invalid_argument if the problem is out of range, a load has no potential, the rod
/// stretches (axial_stiffness), two grips are at one arc length, grips are as far apart as the rod
/// between them is long or farther, a couple that is not on a clamp acts on a rod with obstacles,
/// or confined_to_plane is set for a rod without a plane, with obstacles or with two clamps that
/// hold frames; also as first_frame() and held_d1()
[[nodiscard]] std::vector<PlacedSpan> split(const Problem& problem);

/// Places stiffnesses and natural strains of a rod with material directors in a span, about the
/// axes of the span's frame at its start, in the span's units. Sets `ahead`, and whether the span
/// is still planar.
/// @param anchor  grip from which the span is measured
/// @param placed  span whose other members are already in its frame
void place_material_directors(const Problem& problem, const OrderedGrip& anchor,
                              PlacedSpan& placed);

}  // namespace dlo::energy_model
