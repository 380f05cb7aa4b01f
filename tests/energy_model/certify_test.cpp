#include "certify/certify.hpp"

#include <gtest/gtest.h>

#include "search/span_solver.hpp"

namespace dlo::energy_model {
namespace {

/// A rod that is clamped along x and pulled nearly across, out of its plane.
TEST(Certify, TakesAShapeOfEnoughTermsAndOneOfTheCallers) {
  Span span;
  span.planar = false;
  span.length = 1;
  span.start_direction = Eigen::Vector3d::UnitX();
  span.weight = {0, 1, 20};
  span.loads = {{1, {2, 0, 5}}};
  SpanWorkspace workspace;
  for (const int terms : {0, 9}) {
    SpanOptions options;
    options.terms = terms;
    const SpanSolution solution = std::move(solve_span(span, options, workspace).front());
    EXPECT_EQ(solution.status, SolveStatus::converged) << terms << ": " << solution.message;
    EXPECT_TRUE(solution.resolved);
  }
}

}  // namespace
}  // namespace dlo::energy_model
