#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"

namespace dlo::energy_model {
namespace {

using test::heavy_cantilever;

TEST(WarmStart, AfterASmallTurnOfTheGripperTakesAFewEvaluations) {
  for (const double gamma : {0.2, 10.0, 100.0}) {
    const Equilibrium before = solve_energy(heavy_cantilever(gamma, 0));
    const Equilibrium after = solve_energy(heavy_cantilever(gamma, 1), {.start = &before});
    ASSERT_EQ(after.status, SolveStatus::converged);
    EXPECT_LE(after.evaluations, 5) << gamma;
    const Equilibrium cold = solve_energy(heavy_cantilever(gamma, 1));
    const std::vector<double> s = equal_arc_lengths(1, 11);
    EXPECT_LT((after.sample(s).points - cold.sample(s).points).norm(), 1e-9);
  }
}

TEST(WarmStart, FollowsAMovingGripperWithOneSolver) {
  EnergySolver solver;
  Equilibrium followed = solver.solve(heavy_cantilever(10, 0));
  for (int degrees = 1; degrees <= 20; ++degrees) {
    followed = solver.follow(heavy_cantilever(10, degrees));
    ASSERT_EQ(followed.status, SolveStatus::converged) << followed.message;
    EXPECT_LE(followed.evaluations, 5);
  }
  const std::vector<double> tip = {1.0};
  const Equilibrium cold = solve_energy(heavy_cantilever(10, 20));
  EXPECT_LT((followed.sample(tip).points - cold.sample(tip).points).norm(), 1e-10);
}

double apart(const Equilibrium& a, const Equilibrium& b) {
  const std::vector<double> s = equal_arc_lengths(1, 11);
  return (a.sample(s).points - b.sample(s).points).norm();
}

TEST(Keep, IsFollowAsLongAsTheBranchIsKept) {
  EnergySolver keeps;
  EnergySolver follows;
  EXPECT_FALSE(keeps.keep(heavy_cantilever(10, 0)));
  ASSERT_TRUE(succeeded(keeps.solve(heavy_cantilever(10, 0)).status));
  ASSERT_TRUE(succeeded(follows.solve(heavy_cantilever(10, 0)).status));
  for (const double degrees : {1, 5, 9}) {
    const std::optional<Equilibrium> kept = keeps.keep(heavy_cantilever(10, degrees));
    ASSERT_TRUE(kept);
    EXPECT_EQ(kept->status, SolveStatus::converged);
    EXPECT_LT(apart(*kept, follows.follow(heavy_cantilever(10, degrees))), 1e-12);
  }
}

// A clamp that stands upright and has turned too far for the rod to lean on its side: a rod there
// falls about the clamp's axis. What keep() does not reach it does not forget either.
TEST(Keep, StaysWhereItWasWhenTheBranchHasEnded) {
  EnergySolver solver;
  ASSERT_TRUE(succeeded(solver.solve(heavy_cantilever(10, 80)).status));
  const std::optional<Equilibrium> last = solver.keep(heavy_cantilever(10, 85));
  ASSERT_TRUE(last);
  for (int time = 0; time < 2; ++time) {
    EXPECT_FALSE(solver.keep(heavy_cantilever(10, 100)));
    EXPECT_FALSE(solver.followed());
    const std::optional<Equilibrium> again = solver.keep(heavy_cantilever(10, 85));
    ASSERT_TRUE(again);
    EXPECT_LE(again->evaluations, 3);
    EXPECT_LT(apart(*again, *last), 1e-9);
  }
  const Equilibrium fallen = solver.follow(heavy_cantilever(10, 100));
  EXPECT_TRUE(succeeded(fallen.status));
  EXPECT_GT(apart(fallen, *last), 0.1);
}

TEST(Keep, GoesBackToTheShapeBefore) {
  EnergySolver solver;
  ASSERT_TRUE(succeeded(solver.solve(heavy_cantilever(10, 80)).status));
  const std::optional<Equilibrium> near = solver.keep(heavy_cantilever(10, 85));
  ASSERT_TRUE(near);
  const Equilibrium fallen = solver.follow(heavy_cantilever(10, 100));
  ASSERT_GT(apart(fallen, *near), 0.1);
  solver.go_back();
  const std::optional<Equilibrium> again = solver.keep(heavy_cantilever(10, 85));
  ASSERT_TRUE(again);
  EXPECT_LT(apart(*again, *near), 1e-9);
}

}  // namespace
}  // namespace dlo::energy_model
