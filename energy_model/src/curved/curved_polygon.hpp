#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "base/deadline.hpp"
#include "curved/curved_rod.hpp"

namespace dlo::energy_model {

/// A coarse equilibrium of a curved rod: frames q_i of the intervals h_i of a mesh, at a local
/// minimum of
///     sum 1/2 h (v - u0) . K (v - u0) - sum h_i n_i . t_i,   v = 2 / h vec(q_i* q_(i+1)),
/// h and K of the rod between the intervals' middles, or to a clamp, and n_i the force that they
/// carry, while sum h_i t_i between two grips is the grips' distance.
struct CurvedPolygon {
  std::vector<Eigen::Quaterniond> frames;  ///< of the intervals
  std::vector<double> turns;  ///< of the frames at clamps that do not hold them, about directions
  Eigen::Matrix3Xd force;     ///< n_i with the grips' part
  double energy = 0;
};

/// NLopt's L-BFGS on the quaternions' components, with an augmented Lagrangian that closes the gaps
/// at the grips: downhill from any shape, so that Newton's method starts near a minimum. What is
/// planar across axis 2 stays so.
/// @param held   of the clamps of the rod
/// @param start  frames of the intervals
[[nodiscard]] CurvedPolygon relax_curved(const CurvedRod& rod, const RodMesh& mesh,
                                         const ClampFrames& held,
                                         const std::vector<Eigen::Quaterniond>& start,
                                         const Deadline& deadline);

/// Starts: the rod as it is by nature from its first clamp on, along the force that it carries,
/// straight, and arches, S and loops like those of polygon_minima(), the frames turned along.
/// @param planar  those that do not leave the plane across axis 2
[[nodiscard]] std::vector<std::vector<Eigen::Quaterniond>> curved_starts(const CurvedRod& rod,
                                                                         const RodMesh& mesh,
                                                                         bool planar);

/// Cross-sections at the nodes of a mesh.
[[nodiscard]] std::vector<RodState> curved_states_of(const CurvedRod& rod, const RodMesh& mesh,
                                                     const ClampFrames& held,
                                                     const CurvedPolygon& polygon);

}  // namespace dlo::energy_model
