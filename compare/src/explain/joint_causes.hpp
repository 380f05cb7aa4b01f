#pragma once

#include <functional>

#include "explain/file_causes.hpp"

namespace dlo::compare {

/// Group name (FileCause::same_as) of combinations of several errors.
inline constexpr const char* joint_cause = "several";

/// Calls `look` for all combinations of several errors of a file: its unit, axes, origin and
/// missing ends. Each error after the first counts as one number, and another origin as one more.
/// @param length  length of the rod's axis, with stretch [m]
void look_at_joint_causes(const Scene& scene, const MeasuredShape& shape, double length,
                          const std::function<void(const FileCause&)>& look);

}  // namespace dlo::compare
