#pragma once

#include "../../helpers.hpp"
#include "dlo/compare/error_budget.hpp"

namespace dlo::test {

/// Returns the sum of the shares of all parts of a budget, which tests expect to be 1.
inline double sum_of_shares(const compare::Budget& b) {
  return b.twist.share + b.natural_curvature.share + b.law.share + b.bookkeeping.share +
         b.discretisation.share + b.stretch.share + b.contact.share + b.not_at_rest.share +
         b.interaction.share;
}

}  // namespace dlo::test
