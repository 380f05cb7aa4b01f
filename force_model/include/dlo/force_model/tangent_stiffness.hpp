#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/force_model/rod.hpp"

namespace dlo::force_model {

/// Symmetric part of minus the derivative of the total forces on the free points by their
/// positions. Only the paper's law between unequal segments has an antisymmetric part.
struct StiffnessMatrix {
  std::vector<Eigen::Index> points;  ///< indices of the points that no rigid grip holds
  Eigen::MatrixXd entries;  ///< three rows and columns x, y, z for each point of `points` [N/m]
};

/// Computes the tangent stiffness of a rod without natural angles, including the contributions of
/// tension, pressure and twist. Needs O(N^2) memory.
/// @param points  [m], 3 x rod.points()
/// @throws std::invalid_argument if a shape or number is out of range, or the rod has natural turns
[[nodiscard]] StiffnessMatrix tangent_stiffness(const Rod& rod,
                                                const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// Distance of a shape from equilibrium, and its stability, from the tangent stiffness.
struct [[nodiscard]] EquilibriumCheck {
  /// Whether the stiffness of the free points is positive definite by more than rounding, except
  /// for `neutral_modes`.
  bool stable = false;
  /// Number of modes without stiffness, such as one of a rod between two pins, which can rotate
  /// about the line through them; 3: three or more. If a force acts along one, `stable` is false;
  /// with 3, if any point has a force. The other members exclude these modes.
  int neutral_modes = 0;
  /// The Newton step leads to an equilibrium, as a second step shows: it is at most a quarter of
  /// the first (Kantorovich), or only rounding. Otherwise `remaining_error` is no bound.
  bool proven = false;
  /// RMS distance of the points from that equilibrium, bounded by both steps [m]; -1 unless stable.
  double remaining_error = -1;
  /// RMS displacement of the points along the slowest mode due to the rounding of positions, which
  /// changes the forces of stiff segments by eps c_c |P| / L [m]. No stepping can reduce the error
  /// below it.
  double rounding_error = 0;
  double slowest_mode = 0;  ///< estimate of the smallest eigenvalue, 0 unless stable [N/m]
  Eigen::Matrix3Xd step;    ///< Newton's step [m], 3 x rod.points()
  /// Direction of negative curvature of the free points, 3 x rod.points(): its largest displacement
  /// is 1 [-], and the sum of its displacements points towards +x, else +y, else +z. Empty if there
  /// is none.
  Eigen::Matrix3Xd negative_curvature_direction;
};

/// Solves K dx = F twice. K is minus the derivative of the total forces by the positions of the
/// free points, including the contributions of tension and pressure. F are the total forces on
/// these points, in the given shape and after the first step. For a rod with natural angles only
/// movements in its plane are examined. Needs O(N) time and memory; allocates.
/// @param points  [m], 3 x rod.points()
/// @throws std::invalid_argument if a shape or number is out of range
EquilibriumCheck check_equilibrium(const Rod& rod,
                                   const Eigen::Ref<const Eigen::Matrix3Xd>& points);

}  // namespace dlo::force_model
