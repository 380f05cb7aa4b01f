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
/// @throws InputError if a moving rod does not support the scene, grippers move, there are
/// obstacles, or the initial scene has another length or number of grippers;  ConvergenceError if
/// there is no initial shape, or if the integrator does not reach the last time
[[nodiscard]] ReleasedMotion release_rod(const ReleasedRod& rod, const std::vector<double>& times,
                                         const std::vector<double>& arc_length, int terms);

/// Returns the largest distance of a point at any time between motions with the same times and arc
/// lengths [m].
[[nodiscard]] double largest_distance(const std::vector<Eigen::Matrix3Xd>& a,
                                      const std::vector<Eigen::Matrix3Xd>& b);

/// Returns the motion of a released rod as a chain of rigid segments of equal length h, with point
/// masses and hinges between them whose springs are linear in the angle,
///     V = sum 1/2 EI / h phi^2,
/// in space, without twist. At a clamp the spring is that of half a segment, 2 EI / h, because a
/// segment's direction is that of its middle; a tip has half a segment's mass. The time integration
/// is Verlet's method with the lengths as constraints (SHAKE; Ryckaert, Ciccotti and Berendsen, J.
/// Comput. Phys. 23, 1977), with time steps proportional to h^2 for stability. The result is of
/// second order in h. It shares no code with the energy model except the initial shape.
/// @param segments  N, > 0
/// @param times     growing, at equal distances, from 0 [s], two or more
/// @return points by time [m], 3 x (N + 1)
/// @throws InputError as release_rod(), and if the rod is not straight, round and of one section,
/// stretches, has distributed loads, or is not held by a single gripper at s = 0;  ConvergenceError
/// if there is no initial shape, the constraints do not converge, or at the time limit
[[nodiscard]] std::vector<Eigen::Matrix3Xd> hinge_motion(const ReleasedRod& rod, int segments,
                                                         const std::vector<double>& times,
                                                         const SolveOptions& options = {});

/// Extrapolated limit of chains with N, 2N and 4N segments.
struct HingeLimit {
  std::vector<Eigen::Matrix3Xd> frames;  ///< positions at N + 1 equal arc lengths [m]
  double error = 0;  ///< largest change of a point by the last extrapolation [m]
};

/// Computes the limit by Richardson's extrapolation, for errors of orders 2 and 4 in h. The
/// arguments are those of hinge_motion().
[[nodiscard]] HingeLimit hinge_limit(const ReleasedRod& rod, int segments,
                                     const std::vector<double>& times);

}  // namespace dlo::compare
