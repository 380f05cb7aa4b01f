#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "dlo/energy_model/problem.hpp"
#include "dlo/energy_model/turns.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

/// What the clamps at both ends of a span do with the rod's frame; in the span's frame.
struct HeldFrames {
  double stiffness = 0;              ///< GJ / EI
  Eigen::Vector3d start_d1, end_d1;  ///< not rolled
  HeldTurns turns;
};

/// A span and where it lies in its problem.
struct PlacedSpan {
  Span span;                                            ///< without twist
  std::optional<HeldFrames> frames;                     ///< that twist it
  double ahead = 0;                                     ///< of a rod with material directors: by
                                                        ///< which its d1 is turned from the span's
  bool reversed = false;                                ///< s runs against the arc length
  double start = 0;                                     ///< arc length of s = 0 [m]
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();  ///< rows: the span's axes in space
  std::size_t anchor_grip = 0;
  std::vector<std::size_t> hold_grips;                        ///< of span.holds
  Eigen::Vector3d anchor_position = Eigen::Vector3d::Zero();  ///< [m]

  [[nodiscard]] double s_of(double arc_length, double length) const {
    return (reversed ? start - arc_length : arc_length - start) / length;
  }
};

/// Cuts a problem at its clamps and puts every span into its units and its frame.
/// @throws std::invalid_argument if the problem is out of range or grips are further apart than the
/// rod between them
[[nodiscard]] std::vector<PlacedSpan> split(const Problem& problem);

}  // namespace dlo::energy_model
