// Tests of the exact solver's verdict on stability, against theory; of its results and of its
// report on what it has not searched; of loads next to clamps.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "equilibrium_balance.hpp"
#include "problems.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

bool message_contains(const Equilibrium& equilibrium, const std::string& words) {
  return equilibrium.message.find(words) != std::string::npos;
}

TEST(SecondVariation, OfAnUnloadedRodIsThatOfTheLinearTheory) {
  // The modes are sin((k + 1/2) pi s). The smallest quotient Q / int (|eta'|^2 + |eta|^2) is
  // q / (q + 1) with q = (pi / 2)^2.
  const double q = pi * pi / 4;
  EXPECT_NEAR(solve_exact(heavy_cantilever(0, 0)).smallest_eigenvalue, q / (q + 1), 1e-7);
  // A clamp inside the rod leaves two cantilevers, of which the longer one has the smaller
  // eigenvalue.
  Problem middle = heavy_cantilever(0, 0);
  middle.grips[0].at = 0.25;
  const double longer = pi * pi / 4 / (0.75 * 0.75);
  EXPECT_NEAR(solve_exact(middle).smallest_eigenvalue, longer / (longer + 1), 1e-7);
}

TEST(SecondVariation, ChangesItsSignWhereAnUprightRodBuckles) {
  const double critical = test::self_buckling_gamma;
  for (const double off : {-1e-4, 1e-4}) {
    const std::vector<Equilibrium> found = all_exact(heavy_cantilever(critical * (1 + off), 90));
    // Below the buckling load the straight shape is the only equilibrium; above it is unstable.
    const auto straight =
        std::find_if(found.begin(), found.end(), [](const Equilibrium& equilibrium) {
          return std::abs(test::point_at(equilibrium, 1).x()) < 1e-6;
        });
    ASSERT_NE(straight, found.end());
    EXPECT_EQ(straight->status, off < 0 ? SolveStatus::converged : SolveStatus::saddle);
    EXPECT_EQ(straight->smallest_eigenvalue > 0, off < 0);
    // Linear in the load: d mu / d Gamma is of the order of -1 / Gamma.
    EXPECT_NEAR(straight->smallest_eigenvalue, 0, std::abs(off));
  }
}

TEST(SecondVariation, SeesWhatBucklesOutOfPlane) {
  // A clamp along +x, no weight, loads (0, 3) at 0.5 and (-6, -1) at the tip.
  Problem problem = heavy_cantilever(0, 0);
  problem.loads = {{0.5, {0, 3, 0}}, {1.0, {-6, -1, 0}}};
  const std::vector<Equilibrium> found = all_exact(problem);
  ASSERT_GE(found.size(), 2U);
  EXPECT_EQ(found[0].status, SolveStatus::converged);
  EXPECT_NEAR(found[0].energy.total(), 3.117, 5e-4);
  const auto saddle = std::ranges::find_if(
      found, [](const Equilibrium& e) { return std::abs(e.energy.total() - 3.802) <= 5e-4; });
  ASSERT_NE(saddle, found.end());
  EXPECT_EQ(saddle->status, SolveStatus::saddle);
  EXPECT_LT(saddle->smallest_eigenvalue, 0);
}

TEST(SecondVariation, CountsTheZeroModeOfARod) {
  // An arch between two pins without weight is free to rotate about the line through them.
  Problem arch = heavy_cantilever(0, 0);
  arch.grips = {{0, Eigen::Vector3d::Zero(), std::nullopt}, {1, {0.8, 0, 0}, std::nullopt}};
  const Equilibrium result = test::converged(solve_exact(arch));
  EXPECT_TRUE(message_contains(result, "1 zero mode")) << result.message;
  EXPECT_NEAR(result.smallest_eigenvalue, 0, 1e-7);
  EXPECT_FALSE(message_contains(solve_exact(heavy_cantilever(1, 0)), "zero mode"));
}

TEST(Exact, PutsStableEquilibriaFirst) {
  // Above buckling both mirror images are stable, and rotate about the vertical without a change of
  // energy.
  EXPECT_EQ(all_exact(heavy_cantilever(7.8, 90)).size(), 1U);
  const std::vector<Equilibrium> above = all_exact(heavy_cantilever(8, 90));
  ASSERT_EQ(above.size(), 3U);
  EXPECT_GT(test::point_at(above[0], 1).x(), 0);  // the one towards +x comes first
  EXPECT_EQ(above[0].status, SolveStatus::converged);
  EXPECT_EQ(above[1].status, SolveStatus::converged);
  EXPECT_EQ(above[2].status, SolveStatus::saddle);
  EXPECT_TRUE(message_contains(above[0], "1 zero mode")) << above[0].message;
  EXPECT_LT(above[2].smallest_eigenvalue, 0);
}

TEST(Exact, FindsPairsOfRootsWithinACellOfItsScan) {
  EXPECT_EQ(all_exact(heavy_cantilever(41.4, 0)).size(), 3U);
  const auto folds = test::reference_values().at("bistability_fold_Gamma");
  for (const double degrees : {0.0, 30.0}) {
    const double fold = folds.at(degrees == 0 ? "0" : "30").get<double>();
    for (const double off : {1e-5, 1e-6, 1e-7}) {
      EXPECT_EQ(all_exact(heavy_cantilever(fold * (1 + off), degrees)).size(), 3U) << off;
      EXPECT_EQ(all_exact(heavy_cantilever(fold * (1 - off), degrees)).size(), 1U) << off;
    }
  }
}

TEST(Exact, ReturnsTheStableShapeOfTwoPinsNearEachOther) {
  // The exact solver once returned an unstable equilibrium of 65.4 EI/l, because the polygon had a
  // single interval between the pins.
  Problem problem = heavy_cantilever(2.0506, 0);
  problem.grips = {{0.506, {0, 0, 0}, std::nullopt},
                   {0.567, {-0.0539556788779, -0.0106264590638, 0}, std::nullopt}};
  const Equilibrium result = test::converged(solve_exact(problem));
  EXPECT_GT(result.smallest_eigenvalue, -1e-7);
  EXPECT_LT(result.energy.bending, 17);
  EXPECT_LT(test::balance_of(problem, result, 0.01).worst(), 1e-9);
}

TEST(Exact, ReportsOmittedCombinationsAndKeepsTheLowest) {
  // Five arches between clamps, each with several shapes.
  Problem problem = heavy_cantilever(0, 0);
  problem.grips.clear();
  for (int i = 0; i <= 5; ++i) {
    problem.grips.push_back({i / 5.0, {0.12 * i, 0, 0}, Eigen::Vector3d(1, 0, 0)});
  }
  const std::vector<Equilibrium> all = all_exact(problem);
  ASSERT_EQ(all.size(), 64U);
  EXPECT_TRUE(message_contains(all.front(), "only the lowest 64 combinations"))
      << all.front().message;
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    if (succeeded(all[i].status) != succeeded(all[i + 1].status)) continue;
    EXPECT_LE(all[i].energy.total(), all[i + 1].energy.total() + 1e-9) << i;
  }
}

TEST(Exact, EndsWhenItsTimeIsOver) {
  Problem pins = heavy_cantilever(10, 0);
  pins.grips.clear();
  for (int i = 0; i < 100; ++i) {
    pins.grips.push_back({i / 99.0, {0.9 * i / 99.0, 0, 0}, std::nullopt});
  }
  const Equilibrium result = solve_exact(pins, {.time_limit = 1e-3});
  EXPECT_EQ(result.status, SolveStatus::time_limit);
  EXPECT_TRUE(message_contains(result, "time limit")) << result.message;
  EXPECT_EQ(solve_exact(heavy_cantilever(10, 0), {.time_limit = 1e-9}).status,
            SolveStatus::time_limit);
  EXPECT_THROW((void)solve_exact(pins, {.time_limit = 0}), std::invalid_argument);
}

TEST(Exact, ListsWhatItHasFoundWhenItsTimeIsOver) {
  Problem arch = heavy_cantilever(30, 20);
  arch.grips.push_back({1, {0.55, -0.1, 0}, Eigen::Vector3d(1, 0, 0)});
  const std::vector<Equilibrium> whole = all_exact(arch);
  ASSERT_FALSE(whole.empty());
  int cut_short = 0;
  // The polygons that give the initial guesses take part of the time. Some of these limits end the
  // search after at least one shooting.
  for (double limit = 1; limit > 1e-4; limit /= 1.2) {
    for (const Equilibrium& found : all_exact(arch, {.time_limit = limit})) {
      if (found.status != SolveStatus::time_limit) continue;
      ++cut_short;
      EXPECT_TRUE(message_contains(found, "other equilibria may have less energy"))
          << found.message;
      EXPECT_TRUE(message_contains(found, "converged") || message_contains(found, "saddle"))
          << found.message;
      EXPECT_EQ(message_contains(found, "saddle"), found.smallest_eigenvalue < 0) << found.message;
      EXPECT_LT(test::balance_of(arch, found, 0.02).worst(), 1e-9);
    }
  }
  EXPECT_GT(cut_short, 0);
}

TEST(Exact, RefusesLoadsBeyondDoublePrecisionAndBadOptions) {
  EXPECT_THROW((void)solve_exact(heavy_cantilever(1e7, 0)), std::invalid_argument);
  EXPECT_THROW((void)solve_exact(heavy_cantilever(1, 0), {.tolerance = -1}), std::invalid_argument);
  const Equilibrium result = solve_exact(heavy_cantilever(1, 0));
  EXPECT_THROW((void)test::sample_at(result, 1.1), std::invalid_argument);
}

TEST(LoadBesideAClamp, CountsOnce) {
  // A load nearer than 1e-9 l to a clamp acts on the clamp, on either side of it and at either end
  // of the rod.
  for (const auto& [clamp, load] : {std::pair(5e-10, 0.0),
                                    {0, 5e-10},
                                    {0, 0},
                                    {5e-10, 1.2e-9},
                                    {1, 1 - 5e-10},
                                    {1 - 5e-10, 1},
                                    {0.4, 0.4 + 5e-10}}) {
    SCOPED_TRACE(testing::Message() << clamp << ", " << load);
    Problem problem = heavy_cantilever(0, 0);
    problem.grips[0].at = clamp;
    const double other = clamp > 0.5 ? 0 : 1;
    problem.loads = {{load, {0, 100, 0}}, {other, {0, 1, 0}}};
    for (const Equilibrium& result : {solve_energy(problem), solve_exact(problem)}) {
      ASSERT_TRUE(succeeded(result.status)) << result.message;
      EXPECT_NEAR(result.grips[0].force.y(), -101, 1e-9);
      // Only the load at the other end does work; the load at the clamp does none.
      const double way = test::point_at(result, other).y() - problem.grips[0].position.y();
      EXPECT_NEAR(result.energy.load, -way, 1e-6);
    }
  }
}

TEST(LoadBesideAClamp, DoesItsWorkAtThatClamp) {
  for (const double at : {1.0, 1 - 5e-10}) {
    Problem problem = test::two_clamps(30, 0.9);
    problem.grips[1].position.y() = 0.1;
    problem.grips[1].at = at;
    problem.loads = {{1, {0, 100, 0}}};
    for (const Equilibrium& result : {solve_energy(problem), solve_exact(problem)}) {
      ASSERT_TRUE(succeeded(result.status)) << result.message;
      EXPECT_NEAR(result.energy.load, -10, 1e-9);
      EXPECT_NEAR(result.grips[0].force.y() + result.grips[1].force.y(), 30 - 100, 1e-7);
    }
  }
}

}  // namespace
}  // namespace dlo::energy_model
