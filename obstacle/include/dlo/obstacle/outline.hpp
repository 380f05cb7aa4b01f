#pragma once

#include <Eigen/Core>

#include "dlo/obstacle/body.hpp"

namespace dlo::obstacle {

/// Outline of a body seen from far: its points in a plot, around it counter-clockwise, where the
/// first does not come again. In a plane about which the body is symmetric it is the body's cut
/// too, since it is convex: with a point and its mirror image what is midway is within it.
/// @param right, up  the plot's axes, unit and at right angles
/// @param far  what is endless ends so far from its middle [m], > 0
/// @return 2 x M [m]; empty of a half-space whose edge is not seen, which is behind all of a plot
[[nodiscard]] Eigen::Matrix2Xd outline(const Body& body, const Eigen::Vector3d& right,
                                       const Eigen::Vector3d& up, double far);

}  // namespace dlo::obstacle
