#pragma once

#include <Eigen/Core>

#include "dlo/obstacle/body.hpp"

namespace dlo::obstacle {

/// Returns the outline of a body in parallel projection: its points in a plot, counter-clockwise,
/// without a repetition of the first. If the body is symmetric about the plane of the plot, the
/// outline is also its cross-section there, since the body is convex: the midpoint between a point
/// and its mirror image is inside.
/// @param right, up  axes of the plot, orthonormal
/// @param far  distance from the body's middle at which longer dimensions end [m], > 0
/// @return 2 x M [m]; empty for a half-space whose edge is not visible, which fills the whole plot
[[nodiscard]] Eigen::Matrix2Xd outline(const Body& body, const Eigen::Vector3d& right,
                                       const Eigen::Vector3d& up, double far);

}  // namespace dlo::obstacle
