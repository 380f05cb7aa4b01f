// Rods that grips stretch nearly to their length, up to 1e7 EI/l^2: the tension that their slack
// asks for, and that such problems are solved.

#include <gtest/gtest.h>

#include <cmath>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "newton/augmented_lagrangian.hpp"
#include "problem/segments.hpp"
#include "span/span_starts.hpp"

namespace dlo::energy_model {
namespace {

/// A clamp at an angle to the chord, and a clamp or a pin at the other end, `slack` nearer than l.
Problem stretched(double slack, double first, double last, bool pinned) {
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.weight_per_length = {0, -2, 0.3};
  problem.grips.resize(2);
  problem.grips[0].direction = Eigen::Vector3d(std::cos(first), std::sin(first), 0);
  problem.grips[1].at = 1;
  problem.grips[1].position = {1 - slack, 0, 0};
  if (!pinned) problem.grips[1].direction = Eigen::Vector3d(std::cos(last), 0, std::sin(last));
  return problem;
}

Span span_of(const Problem& problem) {
  Span span;
  span.planar = false;
  span.start_direction = problem.grips[0].direction;
  span.end_direction = problem.grips[1].direction;
  span.holds = {{1, problem.grips[1].position}};
  span.weight = problem.weight_per_length;
  return span;
}

TEST(Taut, TensionIsWhatTheSlackAsksFor) {
  int taut = 0;
  for (const double slack : {1e-2, 1e-3}) {
    for (const double angle : {0.5, 1.5, 3.0}) {
      for (const bool pinned : {false, true}) {
        const Problem problem = stretched(slack, angle, -0.8, pinned);
        const Equilibrium solved = solve_energy(problem);
        ASSERT_EQ(solved.status, SolveStatus::converged)
            << slack << ", " << angle << ": " << solved.message;
        const std::vector<Segment> segments = segments_of(span_of(problem));
        ASSERT_EQ(segments.size(), 1U);
        if (!segments[0].taut()) continue;
        ++taut;
        const Eigen::Vector3d pull = solved.grips[1].force;
        // Layers and sag are added as if neither knew of the other: right but for the layers' share
        // of the length.
        const double tolerance = 1.5 / std::sqrt(pull.norm());
        EXPECT_NEAR(segments[0].tension, pull.norm(), tolerance * pull.norm())
            << slack << ", " << angle << ", " << pinned;
        EXPECT_LT((segments[0].pull - pull.normalized()).norm(), tolerance);
      }
    }
  }
  EXPECT_GE(taut, 8);
}

TEST(Taut, StartsBendAsLoadsAndWeightAcrossThemWantIt) {
  Problem problem = stretched(5e-4, 0.4, -0.3, false);
  problem.weight_per_length = {0, -4000, 1000};
  problem.loads = {{0.3, {0, 24000, 9000}}, {0.7, {500, -9000, 12500}}};
  const Equilibrium solved = solve_energy(problem);
  ASSERT_EQ(solved.status, SolveStatus::converged) << solved.message;
  Span span = span_of(problem);
  for (const Load& load : problem.loads) span.loads.push_back({load.at, load.force});
  ASSERT_TRUE(segments_of(span).front().taut());
  const std::vector<double> s = equal_arc_lengths(1, 201);
  const Eigen::Matrix3Xd start =
      start_fields(span).front()(Eigen::Map<const Eigen::VectorXd>(s.data(), 201)).tangents;
  const Eigen::Matrix3Xd tangents = solved.sample(s).tangents;
  // The load turns it by its share of the tension; that of the start is right to the layers' share
  // of the length, and small angles add up.
  EXPECT_GT((tangents.col(80) - tangents.col(40)).norm(), 0.05);
  EXPECT_LT((start - tangents).colwise().norm().maxCoeff(), 0.006);
}

TEST(Taut, IsSolvedUpToTensionsOfTenMillion) {
  for (const double slack : {1e-2, 1e-3, 5e-4}) {
    for (const double angle : {0.1, 1.5, 3.0}) {
      const Problem problem = stretched(slack, angle, -2.5, false);
      const Equilibrium solved = solve_energy(problem);
      ASSERT_EQ(solved.status, SolveStatus::converged)
          << slack << ", " << angle << ": " << solved.message;
      EXPECT_GT(solved.smallest_eigenvalue, 0);
      const Samples ends = solved.sample(std::vector<double>{0, 1});
      EXPECT_LT((ends.points.col(1) - problem.grips[1].position).norm(), 1e-10);
    }
  }
}

TEST(Taut, AgreesWithMultipleShooting) {
  const Problem problem = stretched(5e-3, 1.2, 0.7, false);
  const Equilibrium energy = solve_energy(problem);
  ASSERT_EQ(energy.status, SolveStatus::converged) << energy.message;
  const Equilibrium exact = solve_exact(problem);
  ASSERT_EQ(exact.status, SolveStatus::converged) << exact.message;
  const std::vector<double> s = equal_arc_lengths(1, 101);
  EXPECT_LT((energy.sample(s).points - exact.sample(s).points).colwise().norm().maxCoeff(), 1e-9);
  EXPECT_LT((energy.grips[0].force - exact.grips[0].force).norm(),
            1e-7 * exact.grips[0].force.norm());
}

TEST(AugmentedLagrangian, MeetsTheGripsFromAStartThatIsFarFromThem) {
  const Span span = span_of(stretched(0.05, 1, -0.5, false));
  SpanSolution solution;
  solution.model = std::make_shared<SpanEnergy>(span, 16);
  solution.terms = 16;
  solution.x.setZero(solution.model->size());
  descend_by_augmented_lagrangian(solution, {.load = span.total_load()});
  ASSERT_EQ(solution.status, SolveStatus::converged) << solution.message;
  Eigen::VectorXd gradient(solution.model->size());
  Eigen::VectorXd missed(solution.model->constraints());
  Eigen::MatrixXd jacobian(solution.model->constraints(), solution.model->size());
  (void)solution.model->value(solution.x, gradient);
  solution.model->constraint(missed, jacobian);
  EXPECT_LT(missed.norm(), 1e-6);
  // The multipliers balance the gradient, to a thousandth of the hundredth that a minimum may miss.
  EXPECT_LT((gradient - jacobian.transpose() * solution.multipliers).norm(),
            1e-5 * (1 + span.total_load() + solution.multipliers.norm()));
}

}  // namespace
}  // namespace dlo::energy_model
