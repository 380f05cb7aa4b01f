#include "newton/newton.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "span/span_solver.hpp"
#include "span/span_workspace.hpp"

namespace dlo::energy_model {
namespace {

/// Returns a span between clamps that lean out of the plane, at 0.8 of the length.
Span leaning_arch(double lean) {
  Span span;
  span.planar = false;
  span.length = 1;
  span.start_direction = Eigen::Vector3d(1, 0, lean).normalized();
  span.end_direction = Eigen::Vector3d(1, 0, -0.3).normalized();
  span.holds = {{1, {0.8, 0, 0}}};
  span.weight = {0, -10, 0};
  return span;
}

class NewtonBesideAShape : public testing::Test {
 protected:
  /// Returns a start for clamps with a slightly different inclination, with the unknowns of
  /// `before_`.
  [[nodiscard]] SpanSolution beside() {
    SpanSolution solution;
    solution.terms = before_.terms;
    solution.model = std::make_shared<SpanEnergy>(leaning_arch(0.3001), before_.terms);
    solution.x = before_.x;
    solution.multipliers = before_.multipliers;
    return solution;
  }
  [[nodiscard]] static NewtonOptions options(NewtonMethod method) {
    return {.load = leaning_arch(0.3).total_load(), .method = method};
  }

  SpanWorkspace workspace_;
  const SpanSolution before_ =
      std::move(solve_span(leaning_arch(0.3), SpanOptions(), workspace_).front());
};

TEST_F(NewtonBesideAShape, AllMethodsFindTheSameOne) {
  ASSERT_TRUE(before_.factor);
  SpanSolution newton = beside();
  newton_solve(newton, options(NewtonMethod::newton), workspace_.newton());
  ASSERT_EQ(newton.status, SolveStatus::converged) << newton.message;
  EXPECT_GT((newton.x - before_.x).norm(), 1e-6);
  EXPECT_LT(newton.next_step, 1e-10);
  for (const NewtonMethod method : {NewtonMethod::simplified, NewtonMethod::corrector}) {
    SpanSolution other = beside();
    NewtonOptions how = options(method);
    how.first_factor = before_.factor;
    newton_solve(other, how, workspace_.newton());
    ASSERT_EQ(other.status, SolveStatus::converged) << other.message;
    EXPECT_LT((other.x - newton.x).norm(), 1e-9);
  }
}

// A factor is a value: who begins with it makes none of its own in the same place.
TEST_F(NewtonBesideAShape, AFactorThatIsBorrowedStaysWhatItIs) {
  const Eigen::MatrixXd hessian = before_.factor->system.hessian();
  const Eigen::VectorXd x = before_.factor->x;
  SpanSolution solution = beside();
  NewtonOptions how = options(NewtonMethod::newton);
  how.first_factor = before_.factor;
  newton_solve(solution, how, workspace_.newton());
  ASSERT_EQ(solution.status, SolveStatus::converged) << solution.message;
  // It ends with one of its own.
  ASSERT_TRUE(solution.factor);
  EXPECT_NE(solution.factor, before_.factor);
  EXPECT_EQ(before_.factor->system.hessian(), hessian);
  EXPECT_EQ(before_.factor->x, x);
}

// A call leaves no state for the next one, not even after its time limit.
TEST_F(NewtonBesideAShape, AMethodLastsForOneCall) {
  SpanSolution first = beside();
  newton_solve(first, options(NewtonMethod::newton), workspace_.newton());
  const Deadline passed(1e-12);
  for (const NewtonMethod method : {NewtonMethod::simplified, NewtonMethod::corrector}) {
    SpanSolution stopped = beside();
    NewtonOptions how = options(method);
    how.first_factor = before_.factor;
    how.deadline = &passed;
    newton_solve(stopped, how, workspace_.newton());
    EXPECT_EQ(stopped.status, SolveStatus::time_limit);
    SpanSolution again = beside();
    newton_solve(again, options(NewtonMethod::newton), workspace_.newton());
    EXPECT_EQ(again.evaluations, first.evaluations);
    EXPECT_EQ(again.x, first.x);
  }
}

TEST_F(NewtonBesideAShape, EndsAsSoonAsItsToleranceIsMet) {
  SpanSolution whole = beside();
  newton_solve(whole, options(NewtonMethod::newton), workspace_.newton());
  SpanSolution rough = beside();
  NewtonOptions how = options(NewtonMethod::newton);
  how.step_tolerance = rough_step;
  newton_solve(rough, how, workspace_.newton());
  ASSERT_EQ(rough.status, SolveStatus::converged) << rough.message;
  EXPECT_LT(rough.evaluations, whole.evaluations);
  EXPECT_LE(rough.next_step, rough_step);
}

}  // namespace
}  // namespace dlo::energy_model
