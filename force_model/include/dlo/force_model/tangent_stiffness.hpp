#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/force_model/rod.hpp"

namespace dlo::force_model {

/// Minus the derivative of the total forces on the free points by their positions, symmetric.
struct StiffnessMatrix {
  std::vector<Eigen::Index> points;  ///< that no rigid grip holds
  Eigen::MatrixXd entries;           ///< x, y, z of each of these points in turn [N/m]
};

/// Of a rod without natural turns, with what tension, pressure and twist add. O(N^2) in memory.
/// @param points  [m], 3 x rod.points()
/// @throws std::invalid_argument if a shape or number is out of range, or the rod has natural turns
[[nodiscard]] StiffnessMatrix tangent_stiffness(const Rod& rod,
                                                const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// What a shape's tangent stiffness says about its distance from equilibrium.
struct [[nodiscard]] EquilibriumCheck {
  /// The stiffness of the free points is positive definite, by more than rounding, but for
  /// `neutral_modes`.
  bool stable = false;
  /// Movements with neither stiffness nor force, at most two: a rod between two pins rotates about
  /// their line. What follows is without them.
  int neutral_modes = 0;
  /// Newton's step, evaluated, leads to an equilibrium: a second one is at most a quarter of it
  /// (Kantorovich), or rounding. Without it `remaining_error` is no bound.
  bool proven = false;
  double remaining_error = -1;  ///< RMS distance of the points to that equilibrium, bounded from
                                ///< both steps [m]
  /// What the rounding of the points' positions, as a force in stiff segments (eps c_c |P| / L),
  /// moves the slowest mode by, RMS over the points [m]: no stepping gets below.
  double rounding_error = 0;
  double slowest_mode = 0;  ///< estimate of the smallest eigenvalue, 0 unless stable [N/m]
  Eigen::Matrix3Xd step;    ///< Newton's step [m], 3 x rod.points()
  /// A direction of negative curvature of the free points, the furthest by 1 and on the
  /// whole towards +x, else +y, else +z [-], 3 x rod.points(); empty if there is none.
  Eigen::Matrix3Xd negative_curvature_direction;
};

/// Solves K dx = F twice, K minus the derivative of the total forces by the free points' positions,
/// with what tension and pressure add to it, and F the total forces on them, here and after the
/// first step. A rod with natural turns is asked about movements in its plane only. O(N) in time
/// and memory; allocates.
/// @param points  [m], 3 x rod.points()
/// @throws std::invalid_argument if a shape or number is out of range
EquilibriumCheck check_equilibrium(const Rod& rod,
                                   const Eigen::Ref<const Eigen::Matrix3Xd>& points);

}  // namespace dlo::force_model
