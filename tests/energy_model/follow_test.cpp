#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"
#include "solved.hpp"
#include "start_along.hpp"

namespace dlo::energy_model {
namespace {

TEST(WarmStart, AfterASmallTurnOfTheGripperTakesAFewEvaluations) {
  for (const double gamma : {0.2, 10.0, 100.0}) {
    const Equilibrium before = solve_energy(heavy_cantilever(gamma, 0));
    const Equilibrium after =
        test::converged(solve_energy(heavy_cantilever(gamma, 1), {.start = &before}));
    EXPECT_LE(after.evaluations, 5) << gamma;
    const Equilibrium cold = solve_energy(heavy_cantilever(gamma, 1));
    EXPECT_LT(test::largest_point_distance(after, cold), 3e-10);
  }
}

// Newton's method converges to the unstable shape, from which the descent is not completed.
TEST(WarmStart, ReturnsAnUnstableShapeIfTheDescentFails) {
  const Problem problem = heavy_cantilever(200, 60);
  const Equilibrium saddle = all_energy(problem).back();
  const Equilibrium again = solve_energy(problem, {.max_evaluations = 1, .start = &saddle});
  EXPECT_EQ(again.status, SolveStatus::saddle) << again.message;
  EXPECT_LT(test::largest_point_distance(again, saddle), 1e-8);
}

TEST(WarmStart, FollowsAMovingGripperWithOneSolver) {
  EnergySolver solver;
  Equilibrium followed = solver.solve(heavy_cantilever(10, 0));
  for (int degrees = 1; degrees <= 20; ++degrees) {
    followed = solver.follow(heavy_cantilever(10, degrees));
    ASSERT_EQ(followed.status, SolveStatus::converged) << followed.message;
    EXPECT_LE(followed.evaluations, 5);
  }
  const Equilibrium cold = solve_energy(heavy_cantilever(10, 20));
  EXPECT_LT((test::point_at(followed, 1) - test::point_at(cold, 1)).norm(), 1e-10);
}

TEST(Keep, AgreesWithFollowOnTheSameBranch) {
  EnergySolver keeps;
  EnergySolver follows;
  EXPECT_FALSE(keeps.try_follow(heavy_cantilever(10, 0)));
  ASSERT_TRUE(succeeded(keeps.solve(heavy_cantilever(10, 0)).status));
  ASSERT_TRUE(succeeded(follows.solve(heavy_cantilever(10, 0)).status));
  for (const double degrees : {1, 5, 9}) {
    const std::optional<Equilibrium> kept = keeps.try_follow(heavy_cantilever(10, degrees));
    ASSERT_TRUE(kept);
    EXPECT_EQ(kept->status, SolveStatus::converged);
    EXPECT_LT(test::largest_point_distance(*kept, follows.follow(heavy_cantilever(10, degrees))),
              3e-13);
  }
}

// A vertical clamp rotates until the rod can no longer lean to its side and snaps about the axis of
// the clamp. If try_follow() does not find a shape, it keeps the previous one.
TEST(Keep, StaysWhereItWasWhenTheBranchHasEnded) {
  EnergySolver solver;
  ASSERT_TRUE(succeeded(solver.solve(heavy_cantilever(10, 80)).status));
  const std::optional<Equilibrium> last = solver.try_follow(heavy_cantilever(10, 85));
  ASSERT_TRUE(last);
  for (int time = 0; time < 2; ++time) {
    EXPECT_FALSE(solver.try_follow(heavy_cantilever(10, 100)));
    EXPECT_FALSE(solver.followed());
    const std::optional<Equilibrium> again = solver.try_follow(heavy_cantilever(10, 85));
    ASSERT_TRUE(again);
    EXPECT_LE(again->evaluations, 3);
    EXPECT_LT(test::largest_point_distance(*again, *last), 3e-10);
  }
  const Equilibrium fallen = test::require_usable(solver.follow(heavy_cantilever(10, 100)));
  EXPECT_GT(test::largest_point_distance(fallen, *last), 0.1);
}

TEST(Keep, UndoRestoresTheShapeBefore) {
  EnergySolver solver;
  ASSERT_TRUE(succeeded(solver.solve(heavy_cantilever(10, 80)).status));
  const std::optional<Equilibrium> near = solver.try_follow(heavy_cantilever(10, 85));
  ASSERT_TRUE(near);
  const Equilibrium fallen = solver.follow(heavy_cantilever(10, 100));
  ASSERT_GT(test::largest_point_distance(fallen, *near), 0.1);
  solver.undo();
  const std::optional<Equilibrium> again = solver.try_follow(heavy_cantilever(10, 85));
  ASSERT_TRUE(again);
  EXPECT_LT(test::largest_point_distance(*again, *near), 3e-10);
}

// Ends of contact are unknowns, whose iteration reaches the point from a part in contact only if it
// predicts the shapes between; without that rounding decided.
TEST(Keep, FollowsAPartToAPointWhateverTheRounding) {
  for (int k = 0; k < 6; ++k) {
    const double radius = 0.03 * (1 + 1e-13 * k);
    const double about = 1.6 / (radius * radius);
    const Equilibrium start = test::start_over_peg(radius);
    EnergySolver solver({.start = &start});
    (void)test::converged(solver.solve(test::rod_pulled_over_peg(radius, 0.6 * about)));
    for (const double share : {0.7, 0.9, 1.1, 1.0, 1.05, 1.025}) {
      EXPECT_TRUE(solver.try_follow(test::rod_pulled_over_peg(radius, share * about)))
          << k << ' ' << share;
    }
  }
}

/// The least clearance of the peg within a thousandth of the length of where the rod touches it.
double least_clearance_near(const Equilibrium& rod, const ContactPart& contact,
                            const obstacle::Body& peg) {
  std::vector<double> s;
  for (int i = -500; i <= 500; ++i) {
    s.push_back((contact.begin + contact.end) / 2 + 2e-6 * i);
  }
  return peg.clearances(rod.sample(s).points).minCoeff();
}

// Where a point contact becomes an interval the slope and the curvature of the clearance are zero,
// so that the position of its minimum is undefined. A step that ends there or beyond must stay on
// the branch.
TEST(Keep, FollowsAPointUntilItLiesAndBack) {
  constexpr double radius = 0.03;
  // At about this tension the point contact becomes an interval.
  const double about = 1.6 / (radius * radius);
  const Equilibrium start = test::start_over_peg(radius);
  EnergySolver solver({.start = &start});
  const Equilibrium first =
      test::converged(solver.solve(test::rod_pulled_over_peg(radius, 0.6 * about)));
  ASSERT_EQ(first.contacts.size(), 1U);
  ASSERT_EQ(first.contacts[0].kind, ContactKind::touching);
  const auto kind_at = [&](double tension) {
    const Problem problem = test::rod_pulled_over_peg(radius, tension);
    const std::optional<Equilibrium> rod = solver.try_follow(problem);
    EXPECT_TRUE(rod) << tension;
    if (!rod) return ContactKind::tip;
    EXPECT_EQ(rod->status, SolveStatus::converged);
    EXPECT_EQ(rod->contacts.size(), 1U);
    // Allowed depth behind an obstacle, checked near the point of contact more closely than a grid
    // of 1000 points does.
    EXPECT_GT(least_clearance_near(*rod, rod->contacts.at(0), problem.obstacles[0].body),
              -1.001e-9);
    return rod->contacts.at(0).kind;
  };
  double touches = 0.9 * about;
  double lies = 1.1 * about;
  ASSERT_EQ(kind_at(0.7 * about), ContactKind::touching);
  ASSERT_EQ(kind_at(touches), ContactKind::touching);
  ASSERT_EQ(kind_at(lies), ContactKind::lying);
  while (lies - touches > 1e-8 * lies) {
    const double middle = (touches + lies) / 2;
    (kind_at(middle) == ContactKind::touching ? touches : lies) = middle;
  }
  // Both sides leave the peg at the same point there: at an angle phi each from the line of their
  // tension, sin(phi / 2) = (EI / T)^(1/2) / 2R.
  const std::optional<Equilibrium> there =
      solver.try_follow(test::rod_pulled_over_peg(radius, touches));
  ASSERT_TRUE(there);
  const Eigen::Vector3d held = there->grips[0].force.normalized();
  const double phi = std::acos(held.y()) / 2;
  // At the distance s from a point contact with the force F the clearance is
  // r s^2 / 2 + F |s|^3 / (12 EI), where r is the relative curvature. For r < 0 the rod penetrates
  // the peg by 8 |r|^3 / (3 F^2), of which 1e-9 of the length is allowed. The error of phi is then
  // 2 tan(phi / 2) |r| R.
  const double force = there->contacts.at(0).force.norm();
  const double curvature = std::cbrt(1e-9 * 3 * force * force / 8);
  EXPECT_NEAR(2 * std::asin(std::sqrt(1 / touches) / (2 * radius)), phi,
              2 * std::tan(phi / 2) * curvature * radius);
  for (const double sign : {-1.0, 1.0}) {
    for (double aside = 0.03; aside > 1e-9; aside /= 30) {
      SCOPED_TRACE(sign * aside);
      EXPECT_EQ(kind_at(touches * (1 - sign * 0.1)),
                sign > 0 ? ContactKind::touching : ContactKind::lying);
      (void)kind_at(touches * (1 + sign * aside));
    }
  }
}

}  // namespace
}  // namespace dlo::energy_model
