#include "dlo/compare/bending_rule.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace dlo::compare {

double paper_bending_stiffness(BendingRule rule, double bending_stiffness, double curvature,
                               double segment_length) {
  const double alpha = curvature * segment_length;
  if (!(bending_stiffness > 0) || !(alpha > 0 && alpha < std::numbers::pi)) {
    throw std::invalid_argument(
        fmt::format("paper_bending_stiffness: EI = {}, L k = {}, must be > 0 and in (0, pi)",
                    bending_stiffness, alpha));
  }
  const double half = std::sin(alpha / 2);
  const double formula_21 =
      bending_stiffness * curvature * curvature / (2 * half * half * half);  // (21)
  switch (rule) {
    case BendingRule::formula_21:
      return formula_21;
    case BendingRule::moment_matched:
      break;
  }
  return formula_21 / alpha;
}

}  // namespace dlo::compare
