#include "certify.hpp"

#include <gtest/gtest.h>

#include "span_solver.hpp"

namespace dlo::energy_model {
namespace {

/// A rod that is clamped along x and pulled along its own axis z, where azimuth and elevation end.
Span span_that_nears_its_axis() {
  Span span;
  span.planar = false;
  span.length = 1;
  span.start_direction = Eigen::Vector3d::UnitX();
  span.weight = {0, 1, 20};
  span.loads = {{1, {2, 0, 5}}};
  return span;
}

TEST(Certify, RefusesAShapeThatMoreTermsWouldChange) {
  const Span span = span_that_nears_its_axis();
  SpanWorkspace workspace;
  SpanSolution solution = std::move(solve_span(span, SpanOptions(), workspace).front());
  ASSERT_TRUE(solution.is_equilibrium()) << solution.message;
  ASSERT_GT(solution.model->elevation(), largest_elevation);
  EXPECT_FALSE(solution.resolved);
  certify_resolved(solution);
  EXPECT_EQ(solution.status, SolveStatus::not_resolved);
  EXPECT_NE(solution.message.find("not resolved by"), std::string::npos) << solution.message;
}

TEST(Certify, KeepsAResolvedShapeAndOneWithTheCallersTerms) {
  Span span = span_that_nears_its_axis();
  span.weight = {0, 20, 1};
  span.loads = {{1, {2, 5, 0}}};
  SpanWorkspace workspace;
  for (const int terms : {0, 9}) {
    SpanOptions options;
    options.terms = terms;
    SpanSolution solution = std::move(solve_span(span, options, workspace).front());
    certify_resolved(solution);
    EXPECT_EQ(solution.status, SolveStatus::converged) << terms << ": " << solution.message;
  }
}

}  // namespace
}  // namespace dlo::energy_model
