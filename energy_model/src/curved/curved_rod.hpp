#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "curved/curved_flow.hpp"
#include "dlo/energy_model/problem.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {

/// A rod with directors that are fixed to its material, curved by nature or of two bending
/// stiffnesses, with all of its grips: torque passes through clamps that do not
/// hold the frame, so it is not cut. In the axes of the frame that the first clamp holds, in units
/// of l, EI/l, EI/l^2.
struct CurvedRod {
  struct Clamp {
    double at = 0;
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit
    /// Of a clamp after the first that holds its frame.
    struct Frame {
      Eigen::Vector3d d1;  ///< across the direction, unit, not rolled
      HeldTurns turns;     ///< from the first clamp on
    };
    std::optional<Frame> frame;
  };
  RodSpan span;               ///< all of the rod, without directions
  std::vector<Clamp> clamps;  ///< by growing s; the first one holds the frame that is 1
  double first_roll = 0;      ///< of that frame, which it contains [rad]
  NaturalStrain natural;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< in space
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();    ///< where positions are zero [m]
  double length = 1;                                   ///< [m]

  /// Null: no clamp there.
  [[nodiscard]] const Clamp* clamp_at(double s) const;
  /// Whether a shape without spins out of its plane across axis 2 is one of its shapes.
  [[nodiscard]] bool planar() const;
};

/// @throws std::invalid_argument if the problem is out of range, or the frame of its first clamp is
/// not known
[[nodiscard]] CurvedRod make_curved_rod(const Problem& problem);

/// Rotations at the clamps of a rod, one each; none: the frame may turn about the direction.
using ClampFrames = std::vector<std::optional<Eigen::Matrix3d>>;

/// The frames that are held if those after the first clamp are let go.
[[nodiscard]] ClampFrames released_frames(const CurvedRod& rod);

/// The frame with a first director, of which the part across the direction counts.
[[nodiscard]] Eigen::Matrix3d frame_of(const Eigen::Vector3d& d1, const Eigen::Vector3d& direction);

}  // namespace dlo::energy_model
