#pragma once

#include <span>
#include <utility>
#include <vector>

#include "dlo/compare/comparison.hpp"

namespace dlo::compare {

struct NamedPart {
  const char* name;
  BudgetPart Budget::*of;
  bool is_neglected = false;  ///< only present if the force model neglects this property
};

[[nodiscard]] std::span<const NamedPart> budget_parts();

/// Returns the parts of a comparison's error budget with their names, without twist and natural
/// curvature that the force model does not neglect and without a contact of 0. The pointers refer
/// to the comparison.
[[nodiscard]] std::vector<std::pair<const char*, const BudgetPart*>> shown_parts(
    const Comparison& comparison);

}  // namespace dlo::compare
