#pragma once

#include <span>

#include "record/field.hpp"
#include "recording/motion_check.hpp"

namespace dlo::compare {

/// Returns the fields of a motion check as a whole, in JSON.
[[nodiscard]] std::span<const Field<MotionCheck>> motion_check_fields();

}  // namespace dlo::compare
