#pragma once

#include <functional>

#include "explain/file_causes.hpp"

namespace dlo::compare {

/// What the causes below are said to be the same as.
inline constexpr const char* joint_cause = "several";

/// Looks at all ways in which several things are wrong with a file at once: its unit, its axes, its
/// origin and the ends that it lacks. Each counts as a number more, but for the first.
/// @param length  of the rod's axis, stretched [m]
void look_at_joint_causes(const Scene& scene, const MeasuredShape& shape, double length,
                          const std::function<void(const FileCause&)>& look);

}  // namespace dlo::compare
