#pragma once

#include "dlo/compare/check.hpp"
#include "dlo/compare/comparison.hpp"
#include "recording/motion_check.hpp"
#include "report/page.hpp"

namespace dlo::compare {

/// Returns a judged shape for a page, without pictures and details.
[[nodiscard]] PageResult page_result(const CheckResult& result);

/// Returns a judged motion for a page, without pictures and details.
[[nodiscard]] PageResult page_result(const MotionCheck& check);

/// Returns a comparison for a page, without pictures and details. It passes if the RMS is within
/// default_tolerance(); its cause is the largest part of the error budget.
[[nodiscard]] PageResult page_result(const Comparison& comparison);

}  // namespace dlo::compare
