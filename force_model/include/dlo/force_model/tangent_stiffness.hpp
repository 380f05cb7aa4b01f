#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/force_model/rod.hpp"

namespace dlo::force_model {

/// What a shape's tangent stiffness says about its distance from equilibrium.
struct [[nodiscard]] EquilibriumCheck {
  bool stable = false;          ///< the stiffness of the free points is positive definite
  double remaining_error = -1;  ///< RMS over the points of Newton's step to the equilibrium [m]
  Eigen::Matrix3Xd step;        ///< that step [m], 3 x rod.points()
  /// A movement of the free points that the stiffness does not resist, the furthest by 1 and on the
  /// whole towards +x, else +y, else +z [-], 3 x rod.points(); empty if stable.
  Eigen::Matrix3Xd falling_direction;
};

/// Solves K dx = F, K minus the derivative of the total forces by the free points' positions, taken
/// by central differences of every fifth point at a time (a joint couples five), F the total forces
/// on them. O(N) in time and memory; allocates.
/// @param points  [m], 3 x rod.points()
/// @throws std::invalid_argument if a shape or number is out of range
EquilibriumCheck check_equilibrium(const Rod& rod,
                                   const Eigen::Ref<const Eigen::Matrix3Xd>& points);

}  // namespace dlo::force_model
