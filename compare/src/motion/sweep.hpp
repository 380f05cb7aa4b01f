#pragma once

#include <Eigen/Core>

#include "dlo/obstacle/body.hpp"

namespace dlo::compare {

/// Returns the radius of the largest ball in a body [m]; infinite for a half-space.
[[nodiscard]] double inner_radius(const obstacle::Body& body);

/// Whether a polyline whose points move on straight lines passes through a body deeper than
/// `depth`.
/// @param before, after  its points at the begin and the end of the motion, 3 x M, M >= 2 [m]
/// @param depth          > 0 [m]
[[nodiscard]] bool sweeps_through(const obstacle::Body& body, const Eigen::Matrix3Xd& before,
                                  const Eigen::Matrix3Xd& after, double depth);

}  // namespace dlo::compare
