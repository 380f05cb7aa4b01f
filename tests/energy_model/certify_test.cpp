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

// Between two clamps in a plane three constraints take all that three terms leave free: there is no
// direction in which a fold could be looked for.
TEST(Certify, TakesAShapeThatNothingIsFreeIn) {
  Span span;
  span.planar = true;
  span.length = 1;
  span.start_direction = Eigen::Vector3d::UnitX();
  span.end_direction = Eigen::Vector3d::UnitX();
  span.holds = {{1, {0.8, 0, 0}}};
  span.weight = {0, -0.2, 0};
  SpanWorkspace workspace;
  SpanOptions options;
  options.terms = 3;
  const SpanSolution solution = std::move(solve_span(span, options, workspace).front());
  EXPECT_EQ(solution.status, SolveStatus::converged) << solution.message;
  EXPECT_EQ(solution.neutral_directions, 0);
}

}  // namespace
}  // namespace dlo::energy_model
