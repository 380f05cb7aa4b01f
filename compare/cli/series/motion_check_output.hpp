#pragma once

#include <string>

#include "format/json.hpp"
#include "recording/motion_check.hpp"

namespace dlo::cli {

/// @param verdict  "pass" or "fail", as a terminal shows it; empty: as it is
[[nodiscard]] std::string motion_check_text(const compare::MotionCheck& check,
                                            const std::string& verdict = {});
/// The document `dlo/motion_check/1`.
[[nodiscard]] Json motion_check_json(const compare::MotionCheck& check);
/// A row a frame.
[[nodiscard]] std::string motion_check_csv(const compare::MotionCheck& check);

}  // namespace dlo::cli
