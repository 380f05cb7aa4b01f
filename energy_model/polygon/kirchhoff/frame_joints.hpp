#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {

/// A place where two frames meet.
struct FrameJoint {
  Eigen::Index left, right;   // frames: of intervals, then of clamps
  Eigen::Index node;          // of the mesh
  double h;                   // of the rod between
  Eigen::Vector3d stiffness;  // of the rod between
  Eigen::Vector3d natural;

  /// Strains less the natural ones are factor vec(turn) - natural.
  [[nodiscard]] double factor(const Eigen::Quaterniond& turn) const {
    return (turn.w() < 0 ? -2 : 2) / h;
  }
  [[nodiscard]] Eigen::Vector3d excess(const Eigen::Quaterniond& turn) const {
    return factor(turn) * turn.vec() - natural;
  }
};

/// Of a polygon, its clamps' frames after the intervals'. Nothing twists a round rod.
[[nodiscard]] std::vector<FrameJoint> frame_joints(const RodSpan& span, const RodMesh& mesh);

/// The frame of a clamp, turned about its direction from where a turn is zero.
[[nodiscard]] Eigen::Quaterniond clamp_frame(const RodSpan& span, std::size_t clamp, double turn);

/// Turns at clamps, of which the first one holds its frame, that the rod beside them has.
[[nodiscard]] std::vector<double> turns_beside(const RodSpan& span, const RodMesh& mesh,
                                               const std::vector<Eigen::Quaterniond>& frames);

}  // namespace dlo::energy_model
