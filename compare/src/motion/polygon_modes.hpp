#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// Largest number of points of a polygon whose modes are computed, by dense matrices.
inline constexpr int most_points_of_modes = 300;

/// The force model's polygon at rest, with its masses and stiffness.
struct MovingPolygon {
  Discretisation discretisation;
  Eigen::Matrix3Xd points;         ///< at rest [m]
  std::vector<Eigen::Index> free;  ///< indices of the points that move
  Eigen::VectorXd masses;          ///< masses of these points, with what hangs on them [kg]
  Eigen::MatrixXd stiffness;       ///< their stiffness matrix; x, y, z of each in turn [N/m]
};

/// Computes the polygon at rest.
/// @throws InputError if the scene has no such polygon, ConvergenceError if it is not stable at
/// rest
[[nodiscard]] MovingPolygon polygon_at_rest(const Scene& scene, const SolveOptions& options);

/// Vibration modes of points on springs: K v = square M v.
struct PolygonModes {
  Eigen::VectorXd masses;   ///< by point
  Eigen::VectorXd squares;  ///< squared angular frequencies, growing [1/s^2]
  Eigen::MatrixXd shapes;   ///< modes as columns, v^T M v = 1

  /// Mode, or modes of one frequency together, most similar to a given displacement.
  struct Match {
    double square = 0;
    double likeness = 0;  ///< their share of the kinetic energy of the displacement [-]
  };
  /// Finds the modes most similar to a displacement.
  /// @param movement  displacement, in the order of the stiffness matrix
  [[nodiscard]] Match nearest(const Eigen::VectorXd& movement) const;
};

/// Computes the modes. @param masses  > 0 [kg]
[[nodiscard]] PolygonModes polygon_modes(const Eigen::MatrixXd& stiffness,
                                         const Eigen::VectorXd& masses);

}  // namespace dlo::compare
