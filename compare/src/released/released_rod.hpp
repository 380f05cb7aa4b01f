#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solve.hpp"
#include "dlo/energy_model/dynamics.hpp"

namespace dlo::compare {

/// A rod that is held in the equilibrium of one scene and released in another one, which lacks part
/// of what held it, such as a force at its tip. It has no damping.
struct ReleasedRod {
  Scene scene;  ///< scene in which it moves
  Scene begin;  ///< scene of the initial equilibrium, with the same rod and grippers
};

/// Motion of a released rod with inertia, in which nothing else moves.
struct ReleasedMotion {
  std::vector<Eigen::Matrix3Xd> frames;  ///< points by time [m], 3 x M
  int terms = 0;                         ///< number of terms of the energy model
  double step_error = 0;                 ///< Dynamics::error_estimate, over the length [-]
};

/// Returns the initial shape. @throws InputError, ConvergenceError if there is none
[[nodiscard]] energy_model::StartingShape released_shape(const ReleasedRod& rod,
                                                         const SolveOptions& options = {});

/// Simulates a released rod by the energy model (energy_model::simulate).
/// @param times       growing, from 0 [s]
/// @param arc_length  of the points [m], M
/// @param terms       number of terms of each field, > 0
/// @throws InputError if a moving rod does not support the scene, or grippers or obstacles move;
/// ConvergenceError if the integrator does not reach the last time
[[nodiscard]] ReleasedMotion release_rod(const ReleasedRod& rod, const std::vector<double>& times,
                                         const std::vector<double>& arc_length, int terms,
                                         const SolveOptions& options = {});

/// Returns the largest distance of a point at any time between motions with the same times and arc
/// lengths [m].
[[nodiscard]] double largest_distance(const std::vector<Eigen::Matrix3Xd>& a,
                                      const std::vector<Eigen::Matrix3Xd>& b);

}  // namespace dlo::compare
