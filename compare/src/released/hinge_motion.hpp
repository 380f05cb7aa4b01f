#pragma once

#include <Eigen/Core>
#include <vector>

#include "released/released_rod.hpp"

namespace dlo::compare {

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
/// @throws InputError if the rod is not straight, round and of one section, or is not held by a
/// single gripper at s = 0;  ConvergenceError if the constraints do not converge, or at the time
/// limit
[[nodiscard]] std::vector<Eigen::Matrix3Xd> hinge_motion(const ReleasedRod& rod, int segments,
                                                         const std::vector<double>& times,
                                                         const SolveOptions& options = {});

/// Extrapolated limit of chains with N, 2N and 4N segments.
struct HingeLimit {
  std::vector<Eigen::Matrix3Xd> frames;  ///< at N + 1 equal arc lengths [m]
  double error = 0;  ///< largest change of a point by the last extrapolation [m]
};

/// Computes the limit by Richardson's extrapolation, for errors of orders 2 and 4 in h. The
/// arguments are those of hinge_motion().
[[nodiscard]] HingeLimit hinge_limit(const ReleasedRod& rod, int segments,
                                     const std::vector<double>& times,
                                     const SolveOptions& options = {});

}  // namespace dlo::compare
