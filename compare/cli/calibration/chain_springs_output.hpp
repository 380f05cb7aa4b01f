#pragma once

#include <string>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "record/field.hpp"

namespace dlo::cli {

/// Joints of the chains that come nearest to a rod.
[[nodiscard]] std::string chains_text(const std::vector<compare::ChainSprings>& chains);
[[nodiscard]] compare::Json chains_json(const std::vector<compare::ChainSprings>& chains);

}  // namespace dlo::cli
