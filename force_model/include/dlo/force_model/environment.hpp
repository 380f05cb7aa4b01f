#pragma once

#include <Eigen/Core>

#include "dlo/obstacle/body.hpp"

namespace dlo::force_model {

/// Plane of an obstacle (paper, Formula 5, constraint 2). It acts on points on the side opposite to
/// `normal`, and only pushes. The paper prints a force that grows with the distance on either side.
struct Wall {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< any point of the plane [m]
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();  ///< unit vector to the free side [-]
  double stiffness = 0;                               ///< c_e [N/m], >= 0
};

/// @throws std::invalid_argument naming the first member that is out of range
void check(const Wall& wall);

/// Returns the force of a wall on a point [N]: c_e d N for a depth d > 0 behind the plane, else
/// zero.
[[nodiscard]] Eigen::Vector3d wall_force(const Wall& wall, const Eigen::Vector3d& position);

/// Returns the potential of wall_force, 1/2 c_e d^2 [J].
[[nodiscard]] double wall_energy(const Wall& wall, const Eigen::Vector3d& position);

/// Body of any form that pushes the rod along the body's normal, as a wall does. It acts on the
/// points only, or on samples along all segments, so that no edge and no thin body can pass between
/// two points.
struct Solid {
  obstacle::Body body;   ///< [m]
  double stiffness = 0;  ///< sum of c_e over all samples of a segment [N/m], >= 0
  /// Equally spaced samples per segment, from its first point on, >= 1
  /// (obstacle::samples_per_segment), and one at the last point of the rod; 1: at the points only.
  int samples = 1;
};

/// @throws std::invalid_argument naming the first member that is out of range
void check(const Solid& solid);

/// Adds the force of a solid on each point [N]. A force within a segment is distributed to its ends
/// by the lever rule.
/// @param points  [m], 3 x N;  @param[in,out] forces  3 x N
void add_solid_forces(const Solid& solid, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                      Eigen::Ref<Eigen::Matrix3Xd> forces);

/// Returns the potential of these forces [J].
[[nodiscard]] double solid_energy(const Solid& solid,
                                  const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// Returns the force [N] of a spring from `position` to `anchor`, c_e (anchor - position) (Formula
/// 5, constraint 3, with the restoring sign that is missing in the print).
/// @param stiffness  c_e [N/m]
[[nodiscard]] Eigen::Vector3d spring_force(double stiffness, const Eigen::Vector3d& anchor,
                                           const Eigen::Vector3d& position);

}  // namespace dlo::force_model
