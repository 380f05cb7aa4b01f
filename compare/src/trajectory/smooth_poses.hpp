#pragma once

#include <vector>

#include "dlo/compare/trajectory.hpp"

namespace dlo::compare {

/// Poses that were measured, without what is faster than a cut-off: positions, directions (of norm
/// 1 again) and rolls each by the least sum
///     sum w_k (x_k - y_k)^2 + lambda sum v_k (x''_k)^2,
/// x'' the second divided difference, w and v the time that a pose stands for (Whittaker's
/// smoothing). It has no lag, keeps what moves evenly, and at equal steps h its gain is that of a
/// Butterworth filter of second order run forward and backward,
///     1 / (1 + (sqrt(2) - 1) (sin(pi f h) / sin(pi f_c h))^4):
/// 1/sqrt(2), or -3 dB, at the cut-off f_c.
/// @param poses   as Trajectory's, three or more
/// @param cutoff  [Hz], > 0, below half of their mean rate
/// @throws std::invalid_argument if that is not so, or smoothing leaves no direction
[[nodiscard]] std::vector<Pose> smooth_poses(std::vector<Pose> poses, double cutoff);

}  // namespace dlo::compare
