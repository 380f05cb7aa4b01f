#include "certify/certify.hpp"

#include <gtest/gtest.h>

#include "problem/split.hpp"
#include "problems.hpp"
#include "span/nearby_equilibria.hpp"
#include "span/span_solver.hpp"

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

/// Between clamps that lean out of the plane, at 0.8 of the length.
Span spatial_arch(double lean) {
  Span span;
  span.planar = false;
  span.length = 1;
  span.start_direction = Eigen::Vector3d(1, 0, lean).normalized();
  span.end_direction = Eigen::Vector3d(1, 0, -0.3).normalized();
  span.holds = {{1, {0.8, 0, 0}}};
  span.weight = {0, -10, 0};
  return span;
}

// A factor of a point nearby tells what one of the shape's own does; one from farther away is not
// taken.
TEST(Certify, AsksTheFactorOnlyNextToThePointThatItIsOf) {
  SpanWorkspace workspace;
  NewtonFactors& factors = workspace.factors();
  const Span span = spatial_arch(0.3);
  SpanSolution solution = std::move(solve_span(span, SpanOptions(), workspace).front());
  ASSERT_EQ(solution.status, SolveStatus::converged) << solution.message;
  const SpanSolution alone = [&] {
    SpanSolution copy = solution;
    copy.factor.reset();
    certify(copy, span.total_load(), factors);
    EXPECT_EQ(copy.factor->distance(copy, 1), 0);
    return copy;
  }();
  for (const double away : {1e-8, 1e-2}) {
    SpanSolution beside = solution;
    beside.x[1] += away;
    factors.factor_at(beside, *beside.at_x(), span.total_load());
    SpanSolution certified = solution;
    certified.factor = beside.factor;
    certify(certified, span.total_load(), factors);
    EXPECT_EQ(certified.status, SolveStatus::converged) << certified.message;
    EXPECT_NEAR(certified.smallest_eigenvalue, alone.smallest_eigenvalue,
                0.02 * alone.smallest_eigenvalue);
    EXPECT_NEAR(certified.factor->distance(certified, 1), away < 1e-3 ? away : 0, 1e-15);
  }
}

// A shape that is followed comes from the factor of the shape before, and is what a search finds.
TEST(Certify, AFollowedShapeIsTheOneThatIsSearchedFor) {
  SpanWorkspace workspace;
  const SpanSolution before =
      std::move(solve_span(spatial_arch(0.3), SpanOptions(), workspace).front());
  ASSERT_TRUE(before.factor);
  const Span span = spatial_arch(0.28);
  SpanOptions options;
  const auto tangents = [&](const Eigen::VectorXd&) { return before.at_x()->tangents(); };
  options.start.field = tangents;
  options.start.known = {before.model, before.x, before.multipliers, before.factor};
  const SpanSolution followed = std::move(solve_span(span, options, workspace).front());
  const SpanSolution searched = std::move(solve_span(span, SpanOptions(), workspace).front());
  ASSERT_EQ(followed.status, SolveStatus::converged) << followed.message;
  EXPECT_TRUE(followed.followed);
  EXPECT_LT(followed.next_step, 1e-10);
  EXPECT_NEAR(followed.energy, searched.energy, 1e-9);
  EXPECT_NEAR(followed.smallest_eigenvalue, searched.smallest_eigenvalue,
              0.02 * searched.smallest_eigenvalue);
}

// Where a planar rod gives way out of its plane the second variation in space is negative along the
// direction that is told, in which its constraints do not change.
TEST(NegativeCurvature, IsThatOfTheRodInSpace) {
  Problem problem = test::heavy_cantilever(200, 90);
  problem.grips.push_back({1, {0.1, 0, 0}, Eigen::Vector3d(0, -1, 0)});
  const Span span = split(problem).front().span;
  ASSERT_TRUE(span.planar);
  SpanWorkspace workspace;
  SearchLog log;
  SpanOptions options;
  options.log = &log;
  int out_of_plane = 0;
  for (const SpanSolution& found : solve_span(span, options, workspace)) {
    if (found.status != SolveStatus::saddle || !found.model->span().planar) continue;
    const std::optional<NegativeCurvature> way = negative_curvature(found);
    if (!way || way->span.planar) continue;
    ++out_of_plane;
    SpanEnergy model(way->span, found.terms);
    const Eigen::VectorXd x = model.prolong(*found.model, found.x);
    const auto lagrangian = [&](double step, const Eigen::VectorXd& multipliers) {
      const SpanPoint at = model.evaluated(x + step * way->direction);
      EXPECT_NEAR((at.jacobian * way->direction).norm(), 0, step == 0 ? 1e-8 : 1) << step;
      const Eigen::VectorXd own =
          at.jacobian.transpose().completeOrthogonalDecomposition().solve(at.gradient);
      return std::pair(at.energy - multipliers.dot(at.residual), own);
    };
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(model.constraints());
    const Eigen::VectorXd multipliers = lagrangian(0, none).second;
    // d.H d by differences, of errors of 1e-7 by truncation and by rounding.
    constexpr double step = 1e-3;
    const double second =
        (lagrangian(step, multipliers).first + lagrangian(-step, multipliers).first -
         2 * lagrangian(0, multipliers).first) /
        (step * step);
    EXPECT_LT(second, -1e-6) << found.energy;
  }
  EXPECT_GE(out_of_plane, 1);
}

}  // namespace
}  // namespace dlo::energy_model
