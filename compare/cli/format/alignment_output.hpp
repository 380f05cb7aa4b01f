#pragma once

#include <string>

#include "dlo/compare/alignment.hpp"
#include "format/json.hpp"

namespace dlo::cli {

/// From which arc length to which a shape runs on its reference, in a few words.
[[nodiscard]] std::string range_text(const compare::Alignment& alignment, double length);

[[nodiscard]] std::string pose_text(const compare::RigidMotion& pose, double length);

[[nodiscard]] Json to_json(const compare::Alignment& alignment);

}  // namespace dlo::cli
