#pragma once

#include <span>
#include <utility>
#include <vector>

#include "dlo/compare/comparison.hpp"

namespace dlo::compare {

/// Whether the force model left something out that the scene has (Solution::neglected).
[[nodiscard]] bool neglects(const Comparison& comparison, const char* what);

/// A part of an error budget, by its name.
struct NamedPart {
  const char* name;
  const char* words;  ///< in a sentence
  BudgetPart Budget::*of;
  bool is_neglected = false;  ///< it is there where the force model neglects what is called so
};

/// All of them.
[[nodiscard]] std::span<const NamedPart> budget_parts();

/// The parts of a comparison's error budget that are told, by name: without those that its scene
/// has not. They point into the comparison.
[[nodiscard]] std::vector<std::pair<const char*, const BudgetPart*>> shown_parts(
    const Comparison& comparison);

}  // namespace dlo::compare
