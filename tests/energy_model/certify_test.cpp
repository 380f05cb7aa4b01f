#include "certify/certify.hpp"

#include <gtest/gtest.h>

#include "linear/reduced_hessian.hpp"
#include "newton/newton.hpp"
#include "problem/split.hpp"
#include "problems.hpp"
#include "span/nearby_equilibria.hpp"
#include "span/span_solver.hpp"

namespace dlo::energy_model {
namespace {

// Between two clamps in a plane, three constraints determine the three unknowns. No direction is
// left in which a fold could be searched for.
TEST(Certify, AcceptsAShapeWithoutFreeUnknowns) {
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

/// Returns a span between clamps that lean out of the plane, at 0.8 of the length.
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

// The eigenvalues are those at the shape itself, even if the stored factor belongs to another
// point.
TEST(Certify, UsesTheFactorAtTheShapeItself) {
  SpanWorkspace workspace;
  NewtonBuffers& buffers = workspace.newton();
  const Span span = spatial_arch(0.3);
  const SpanSolution solution = std::move(solve_span(span, SpanOptions(), workspace).front());
  ASSERT_EQ(solution.status, SolveStatus::converged) << solution.message;
  SpanSolution alone = solution;
  alone.factor.reset();
  certify(alone, buffers);
  for (const double away : {1e-8, 3e-5, 1e-2}) {
    SpanSolution beside = solution;
    beside.x[1] += away;
    buffers.factor_at(beside, *beside.at_x());
    SpanSolution certified = solution;
    certified.factor = beside.factor;
    certify(certified, buffers);
    EXPECT_EQ(certified.status, SolveStatus::converged) << certified.message;
    EXPECT_EQ(certified.smallest_eigenvalue, alone.smallest_eigenvalue);
    EXPECT_EQ(certified.factor->distance(certified), 0);
  }
}

/// Returns the straight shape of a rod that is clamped at its begin, before it is certified.
SpanSolution straight_shape(const Span& span) {
  SpanSolution solution;
  solution.status = SolveStatus::converged;
  solution.terms = 20;
  solution.model = std::make_shared<SpanEnergy>(span, solution.terms);
  solution.x = Eigen::VectorXd::Zero(solution.model->size());
  solution.multipliers = Eigen::VectorXd::Zero(solution.model->constraints());
  return solution;
}

/// Returns a clamped vertical rod close to self-buckling, whose smallest eigenvalue is about a
/// hundredth.
Span nearly_buckling() {
  Span span;
  span.length = 1;
  span.start_direction = Eigen::Vector3d::UnitY();
  span.end_direction.reset();
  span.weight = {0, -7.8, 0};  // buckles at 7.837
  return span;
}

SpanSolution straight_upright_shape(SpanWorkspace& workspace) {
  const Span span = nearly_buckling();
  SpanSolution solution = std::move(solve_span(span, SpanOptions(), workspace).front());
  solution.factor.reset();
  certify(solution, workspace.newton());
  EXPECT_EQ(solution.status, SolveStatus::converged) << solution.message;
  EXPECT_LT(solution.smallest_eigenvalue, 0.02);
  EXPECT_GT(solution.smallest_eigenvalue, 1e-4);
  return solution;
}

// Along the eigenvector of the smallest eigenvalue a shape may be far from equilibrium with a
// residual of almost zero. Only the Newton step shows this, and the direction counts as neutral.
TEST(Certify, CallsAShapeWhoseNextStepIsNotSmallUndetermined) {
  SpanWorkspace workspace;
  const SpanSolution solution = straight_upright_shape(workspace);
  const Eigen::VectorXd soft =
      eigenvector_by_magnitude(solution.factor->system.reduced_hessian(), 0).normalized();
  for (const double away : {1e-9, 1e-6}) {
    SpanSolution moved = solution;
    moved.x += away * soft;
    certify(moved, workspace.newton());
    EXPECT_NEAR(moved.next_step, away, 0.1 * away);
    EXPECT_LE(moved.residual, 1e-8);
    EXPECT_EQ(moved.status, away < 1e-8 ? SolveStatus::converged : SolveStatus::near_singular);
    EXPECT_EQ(moved.neutral_directions, away < 1e-8 ? 0 : 1);
  }
}

// Above its buckling load the upright shape is a saddle. A nearby shape whose next Newton step is
// not small does not prove this.
TEST(Certify, CallsASaddleWhoseNextStepIsNotSmallUndetermined) {
  Span span = nearly_buckling();
  span.planar = true;
  span.weight = {0, -7.9, 0};
  SpanWorkspace workspace;
  const SpanSolution straight = straight_shape(span);
  SpanSolution saddle = straight;
  certify(saddle, workspace.newton());
  EXPECT_EQ(saddle.status, SolveStatus::saddle) << saddle.message;
  SpanSolution moved = straight;
  moved.x +=
      1e-6 * eigenvector_by_magnitude(saddle.factor->system.reduced_hessian(), 0).normalized();
  certify(moved, workspace.newton());
  EXPECT_LE(moved.residual, 1e-8);
  EXPECT_LT(moved.smallest_eigenvalue, -1e-4);
  EXPECT_EQ(moved.status, SolveStatus::near_singular);
}

/// Returns a converged shape between clamps, whose multipliers are not zero.
SpanSolution arch_at_rest(SpanWorkspace& workspace) {
  SpanSolution solution =
      std::move(solve_span(spatial_arch(0.3), SpanOptions(), workspace).front());
  EXPECT_EQ(solution.status, SolveStatus::converged) << solution.message;
  return solution;
}

// Grip forces with an error of 1e-7 of all forces leave a residual, but the Newton step does not
// move the shape.
TEST(Certify, RejectsAResidualAboveItsLimit) {
  SpanWorkspace workspace;
  const SpanSolution solution = arch_at_rest(workspace);
  const double scale = solution.scale_of_forces();
  const Eigen::RowVectorXd force = solution.at_x()->jacobian.row(0);
  for (const double share : {1e-9, 1e-7}) {
    SpanSolution pulled = solution;
    pulled.multipliers[0] += share * scale / force.norm();
    certify(pulled, workspace.newton());
    EXPECT_NEAR(pulled.residual, share * scale, 0.1 * share * scale);
    EXPECT_EQ(pulled.status, share < 1e-8 ? SolveStatus::converged : SolveStatus::failed);
    if (share > 1e-8) EXPECT_EQ(pulled.message, "the residual of the returned shape is not small");
  }
}

TEST(Certify, RejectsGripsThatPullWithoutBound) {
  SpanWorkspace workspace;
  SpanSolution solution = arch_at_rest(workspace);
  solution.multipliers[0] = 1e15;
  certify(solution, workspace.newton());
  EXPECT_EQ(solution.status, SolveStatus::failed);
  EXPECT_EQ(solution.message, "the reactions of the grips are unbounded");
}

// certify() keeps a status by which Newton's method has not found or not determined an equilibrium.
TEST(Certify, ClaimsNoMoreThanTheSearch) {
  SpanWorkspace workspace;
  const SpanSolution solution = arch_at_rest(workspace);
  for (const SolveStatus status :
       {SolveStatus::near_singular, SolveStatus::failed, SolveStatus::evaluation_limit}) {
    SpanSolution left = solution;
    left.status = status;
    certify(left, workspace.newton());
    EXPECT_EQ(left.status, status);
  }
  SpanSolution saddle = solution;
  saddle.status = SolveStatus::saddle;
  certify(saddle, workspace.newton());
  EXPECT_EQ(saddle.status, SolveStatus::converged);
}

/// Returns the straight shape of a rod without weight that is clamped at its begin and passes
/// through or next to a soft body, before it is certified.
SpanSolution straight_through(const obstacle::Body& body, double stiffness) {
  Span span;
  span.length = 1;
  span.start_direction = Eigen::Vector3d::UnitX();
  Span::SoftObstacle obstacle;
  obstacle.body = body;
  obstacle.stiffness = stiffness;
  span.soft_obstacles = {obstacle};
  return straight_shape(span);
}

// A rod through the axis of a soft cylinder is unstable: the energy decreases to both sides. Nodes
// that are not on the axis do not show this. A rod very near to the axis is near singular.
TEST(Certify, CallsNoShapeStableThatPassesTheMiddleOfAYieldingBody) {
  SpanWorkspace workspace;
  using obstacle::Body;
  constexpr double soft = 0.01;
  SpanSolution beside = straight_through(Body::cylinder({0.503, 0.05, 0}, {0, 0, 1}, 0.1), 0);
  certify(beside, workspace.newton());
  EXPECT_EQ(beside.status, SolveStatus::converged) << beside.message;
  SpanSolution through = straight_through(Body::cylinder({0.503, 0, 0}, {0, 0, 1}, 0.1), soft);
  certify(through, workspace.newton());
  EXPECT_GT(through.smallest_eigenvalue, 0.01);
  EXPECT_EQ(through.status, SolveStatus::saddle);
  SpanSolution near = straight_through(Body::cylinder({0.503, 1e-3, 0}, {0, 0, 1}, 0.1), 1e-9);
  certify(near, workspace.newton());
  EXPECT_EQ(near.status, SolveStatus::near_singular);
  EXPECT_EQ(near.neutral_directions, 1);
}

// If a planar rod is unstable out of its plane, the second variation in space is negative along the
// returned direction, in which its constraints do not change.
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
    const std::optional<NegativeCurvature> descent = negative_curvature(found);
    if (!descent || descent->span.planar) continue;
    ++out_of_plane;
    SpanEnergy model(descent->span, found.terms);
    const Eigen::VectorXd x = model.prolong(*found.model, found.x);
    const auto lagrangian = [&](double step, const Eigen::VectorXd& multipliers) {
      const SpanPoint at = model.evaluated(x + step * descent->direction);
      EXPECT_NEAR((at.jacobian * descent->direction).norm(), 0, step == 0 ? 1e-8 : 1) << step;
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
