#pragma once

#include <Eigen/Core>
#include <vector>

#include "released/released_rod.hpp"

namespace dlo::compare {

/// The motion of a released rod as a chain of rigid segments of equal length h, with point masses
/// and hinges between them whose springs are linear in the angle,
///     V = sum 1/2 EI / h phi^2,
/// in space, without twist. At a clamp the spring is that of half a segment, 2 EI / h, because a
/// segment's direction is that of its middle; a tip has half a segment's mass. By time it is
/// Verlet's method with the lengths as constraints (SHAKE; Ryckaert, Ciccotti and Berendsen, J.
/// Comput. Phys. 23, 1977), with steps as short as h^2 asks for. So it is of second order in h. It
/// shares no code with the energy model but the shape that motion begins with.
/// @param segments  N, > 0
/// @param times     growing, at equal distances, from 0 [s], two or more
/// @return points by time [m], 3 x (N + 1)
/// @throws InputError if the rod is not straight, round and of one section, or is held other than
/// by one gripper at s = 0;  ConvergenceError if the constraints cannot be held, or at the time
/// limit
[[nodiscard]] std::vector<Eigen::Matrix3Xd> hinge_motion(const ReleasedRod& rod, int segments,
                                                         const std::vector<double>& times,
                                                         const SolveOptions& options = {});

/// What N, 2N and 4N segments converge to.
struct HingeLimit {
  std::vector<Eigen::Matrix3Xd> frames;  ///< at N + 1 equal arc lengths [m]
  double error = 0;                      ///< what the finest has changed of it, largest [m]
};

/// By Richardson's extrapolation, of errors of orders 2 and 4 in h. Arguments as above.
[[nodiscard]] HingeLimit hinge_limit(const ReleasedRod& rod, int segments,
                                     const std::vector<double>& times,
                                     const SolveOptions& options = {});

}  // namespace dlo::compare
