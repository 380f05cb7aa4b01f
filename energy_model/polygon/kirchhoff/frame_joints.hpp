#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {

/// Joint between two neighbouring frames: of intervals, or of an interval and a clamp.
struct FrameJoint {
  Eigen::Index left, right;   // indices of frames: first those of intervals, then those of clamps
  Eigen::Index node;          // node of the mesh
  double h;                   // length of the rod between the two frames
  Eigen::Vector3d stiffness;  // stiffness of that rod about d1, d2 and the tangent
  Eigen::Vector3d natural;

  /// Returns f, with which the strains minus the natural ones are f vec(turn) - natural.
  [[nodiscard]] double factor(const Eigen::Quaterniond& turn) const {
    return (turn.w() < 0 ? -2 : 2) / h;
  }
  [[nodiscard]] Eigen::Vector3d excess(const Eigen::Quaterniond& turn) const {
    return factor(turn) * turn.vec() - natural;
  }
};

/// Returns the joints of a polygon, in whose list of frames those of clamps follow those of
/// intervals. A round rod has no torsional stiffness here.
[[nodiscard]] std::vector<FrameJoint> frame_joints(const RodSpan& span, const RodMesh& mesh);

/// Returns the frame of a clamp, rotated by `turn` about its direction from the reference frame
/// [rad].
[[nodiscard]] Eigen::Quaterniond clamp_frame(const RodSpan& span, std::size_t clamp, double turn);

/// Returns the rotation of the frame of each clamp about its direction that the adjacent interval
/// has [rad]; that of the first clamp, which holds its frame, is 0.
[[nodiscard]] std::vector<double> adjacent_interval_turns(
    const RodSpan& span, const RodMesh& mesh, const std::vector<Eigen::Quaterniond>& frames);

}  // namespace dlo::energy_model
