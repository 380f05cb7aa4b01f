#pragma once

#include "dlo/compare/choice.hpp"

namespace dlo::compare {

/// Rule by which c_b of the paper's law follows from the material.
enum class BendingRule {
  formula_21,      ///< the paper's: EI k^2 / ((1 - cos a) sin(a/2)), a = L k
  moment_matched,  ///< the rod's moment at curvature k: Formula 21 divided by a
};

/// Names of the rules.
template <>
struct Choices<BendingRule> {
  /// All values, in the order of the enumeration.
  static constexpr Choice<BendingRule> all[] = {
      {BendingRule::formula_21, "formula_21", "the paper's"},
      {BendingRule::moment_matched, "moment_matched", "the rod's moment at design_curvature"}};
};

/// Returns c_b [N] of the paper's law for a material.
///     formula_21:      EI k^2 / ((1 - cos a) sin(a/2)),  a = L k (Formula 21 with L = l/(N-1))
///     moment_matched:  Formula 21 divided by a, so that the joint's moment at curvature k is EI k
/// @param bending_stiffness  EI [N m^2], > 0;  @param curvature  k [1/m], > 0
/// @param segment_length     L [m], > 0, with L k < pi
/// @throws std::invalid_argument if EI or L k is out of range
[[nodiscard]] double paper_bending_stiffness(BendingRule rule, double bending_stiffness,
                                             double curvature, double segment_length);

}  // namespace dlo::compare
