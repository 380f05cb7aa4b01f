#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// Most points of a polygon whose modes are worked out, by dense matrices.
inline constexpr int most_points_of_modes = 300;

/// The polygon of the force model at rest, as one that moves.
struct MovingPolygon {
  Discretisation discretisation;
  Eigen::Matrix3Xd points;         ///< at rest [m]
  std::vector<Eigen::Index> free;  ///< of the points those that move
  Eigen::VectorXd masses;          ///< of these, with what hangs on them [kg]
  Eigen::MatrixXd stiffness;       ///< x, y, z of each of these in turn [N/m]
};

/// @throws InputError if the scene has no such polygon, ConvergenceError if it is not stable at
/// rest
[[nodiscard]] MovingPolygon polygon_at_rest(const Scene& scene, const SolveOptions& options);

/// Vibrations of points on springs: K v = square M v.
struct PolygonModes {
  Eigen::VectorXd masses;   ///< by point
  Eigen::VectorXd squares;  ///< growing
  Eigen::MatrixXd shapes;   ///< by column, v^T M v = 1

  /// The mode, or modes of one frequency together, that move most like a movement.
  struct Match {
    double square = 0;
    double likeness = 0;  ///< share of the movement's kinetic energy that they have [-]
  };
  /// @param movement  as the stiffness is ordered
  [[nodiscard]] Match nearest(const Eigen::VectorXd& movement) const;
};

/// @param masses  > 0 [kg]
[[nodiscard]] PolygonModes polygon_modes(const Eigen::MatrixXd& stiffness,
                                         const Eigen::VectorXd& masses);

}  // namespace dlo::compare
