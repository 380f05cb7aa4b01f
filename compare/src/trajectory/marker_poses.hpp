#pragma once

#include <optional>
#include <vector>

#include "dlo/compare/trajectory.hpp"
#include "trajectory/read_markers.hpp"

namespace dlo::compare {

/// Poses of a gripper that two markers on it show, the rod straight between and beyond them: of
/// those at arc lengths s_1 < s_2 seen at a and b it is
///     direction = (b - a) / |b - a|,   position = (a + b) / 2 + (at - (s_1 + s_2) / 2) direction,
/// which comes nearest to both (least squares). Each marker has its own times: where one was not
/// seen it is on its Trajectory. Poses are at the times of that with more rows, while both are
/// seen.
/// @param at      where the gripper holds the rod [m]
/// @param cutoff  each marker is smoothed by itself, as by smooth_poses() [Hz]; none: not
/// @throws InputError naming the file unless there are two markers, seen at the same time, and on
/// average as far apart as their arc lengths, to a fifth; std::invalid_argument as smooth_poses()
[[nodiscard]] std::vector<Pose> poses_of_markers(const MarkerMotion& markers, double at,
                                                 std::optional<double> cutoff);

}  // namespace dlo::compare
