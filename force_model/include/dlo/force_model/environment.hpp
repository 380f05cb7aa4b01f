#pragma once

#include <Eigen/Core>

#include "dlo/obstacle/body.hpp"

namespace dlo::force_model {

/// An obstacle's plane (paper, Formula 5, constraint 2). It acts on the side `normal` points away
/// from, and it only pushes: the paper prints a force that grows with the distance on either side.
struct Wall {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< a point of the plane [m]
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();  ///< unit vector to the free side [-]
  double stiffness = 0;                               ///< c_e [N/m], >= 0
};

/// @throws std::invalid_argument naming the first member that is out of range
void check(const Wall& wall);

/// Force of a wall on a point: c_e d N for a depth d > 0 behind the plane, else zero [N].
[[nodiscard]] Eigen::Vector3d wall_force(const Wall& wall, const Eigen::Vector3d& position);

/// Potential of wall_force, 1/2 c_e d^2 [J].
[[nodiscard]] double wall_energy(const Wall& wall, const Eigen::Vector3d& position);

/// A body of any form, which pushes the rod as a wall does, along the body's own normal: at its
/// points or, so that no edge and no thin body slips between two of them, all along its segments.
struct Solid {
  obstacle::Body body;   ///< [m]
  double stiffness = 0;  ///< c_e of all samples of a segment together [N/m], >= 0
  int samples = 1;       ///< to a segment, >= 1 (obstacle::samples_per_segment); 1: at its end
};

/// @throws std::invalid_argument naming the first member that is out of range
void check(const Solid& solid);

/// Adds what a solid does to each point [N]; what pushes within a segment is shared by its ends as
/// a lever does.
/// @param points  [m], 3 x N;  @param[in,out] forces  3 x N
void add_solid_forces(const Solid& solid, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                      Eigen::Ref<Eigen::Matrix3Xd> forces);

/// Potential of these forces [J].
[[nodiscard]] double solid_energy(const Solid& solid,
                                  const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// Force of a spring that pulls `position` to `anchor` (Formula 5, constraint 3, with the restoring
/// sign that the print lacks): c_e (anchor - position) [N].
/// @param stiffness  c_e [N/m]
[[nodiscard]] Eigen::Vector3d spring_force(double stiffness, const Eigen::Vector3d& anchor,
                                           const Eigen::Vector3d& position);

}  // namespace dlo::force_model
