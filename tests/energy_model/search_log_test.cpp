// Tests of the log of a search for all equilibria: which initial guesses it has used and omitted.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"
#include "random_problems.hpp"
#include "rolled_clamps.hpp"

namespace dlo::energy_model {
namespace {

int new_equilibria(const EnergySearch& search) {
  int sum = 0;
  for (const SearchStrategy& strategy : search.strategies) sum += strategy.new_equilibria;
  return sum;
}

std::string omitted_text(const EnergySearch& search) {
  std::string all;
  for (const std::string& what : search.omitted) all += what + "\n";
  return all;
}

/// Expects that the strategies together count each equilibrium of a rod of one span exactly once as
/// found first.
void expect_counts_add_up(const Problem& problem) {
  const EnergySearch search = search_energy(problem);
  ASSERT_FALSE(search.strategies.empty());
  const bool any = search.equilibria.front().status != SolveStatus::failed;
  EXPECT_EQ(new_equilibria(search), any ? static_cast<int>(search.equilibria.size()) : 0);
  for (const SearchStrategy& strategy : search.strategies) {
    EXPECT_GE(strategy.tried, strategy.new_equilibria) << strategy.name;
    EXPECT_GT(strategy.tried, 0) << strategy.name;
  }
  EXPECT_EQ(search.equilibria.size(), all_energy(problem).size());
}

TEST(SearchLog, EachEquilibriumHasTheEnergiesOfTheStableOnes) {
  Problem arch = two_clamps(5, 0.8);
  arch.confined_to_plane = true;
  Problem both = two_clamps(5, 0.6);
  both.grips.insert(both.grips.begin() + 1, {0.5, {0.3, 0, 0}, Eigen::Vector3d::UnitX()});
  both.confined_to_plane = true;
  for (const Problem& problem : {arch, both}) {
    const EnergySearch search = search_energy(problem);
    std::vector<double> stable;
    for (const Equilibrium& found : search.equilibria) {
      if (succeeded(found.status)) stable.push_back(found.energy.total());
    }
    ASSERT_GE(stable.size(), 2);
    for (const Equilibrium& found : search.equilibria) EXPECT_EQ(found.stable_energies, stable);
    // A search for the equilibrium of lowest energy ends earlier and finds a subset of these.
    const Equilibrium lowest = solve_energy(problem);
    ASSERT_FALSE(lowest.stable_energies.empty());
    EXPECT_EQ(lowest.stable_energies.front(), lowest.energy.total());
    for (const double energy : lowest.stable_energies) {
      EXPECT_TRUE(std::ranges::any_of(stable, [energy](double other) {
        return std::abs(energy - other) < 1e-8 * (1 + std::abs(other));
      })) << energy;
    }
    EXPECT_TRUE(solve_energy(problem, {.start = &lowest}).stable_energies.empty());
  }
}

TEST(SearchLog, AShapeThatTurnsFreelyIsListedOnce) {
  // Shapes that differ by a rotation about the line through the pins count once. The weight, if
  // any, is along this line.
  for (const double gamma : {0.0, 10.0, 40.0}) {
    SCOPED_TRACE(gamma);
    Problem pins = heavy_cantilever(gamma, 0);
    pins.grips = {{0, {0, 0, 0}}, {1, {0, -0.6, 0}}};
    const std::vector<Equilibrium> all = all_energy(pins);
    EXPECT_GE(all.size(), 2U);
    const std::vector<double> s = {0.1, 0.3, 0.5, 0.7, 0.9};
    const auto distances = [&](const Equilibrium& of) {
      // Distance from the line and position along it, which a rotation about it does not change.
      const Eigen::Matrix3Xd points = of.sample(s).points;
      Eigen::Matrix2Xd kept(2, points.cols());
      kept << points.row(1),
          Eigen::VectorXd((points.row(0).array().square() + points.row(2).array().square()).sqrt())
              .transpose();
      return kept;
    };
    const auto leaves_plane = [&](const Equilibrium& of) {
      return of.sample(s).points.row(2).cwiseAbs().maxCoeff() > 1e-6;
    };
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        // In a plane, a shape that bends to the left and one that bends to the right are different
        // equilibria.
        if (!leaves_plane(all[i]) && !leaves_plane(all[j])) continue;
        EXPECT_GT((distances(all[i]) - distances(all[j])).norm(), 1e-5) << i << ", " << j;
      }
    }
  }
}

TEST(SearchLog, AccountsForEveryEquilibriumOfOneSpan) {
  expect_counts_add_up(heavy_cantilever(1, 0));
  expect_counts_add_up(heavy_cantilever(60, 0));
  expect_counts_add_up(two_clamps(10, 0.6));
  Problem pins = heavy_cantilever(10, 0);
  pins.grips = {{0, {0, 0, 0}}, {1, {0.3, 0.1, 0}}};
  expect_counts_add_up(pins);
  Problem curved = heavy_cantilever(20, -90);
  curved.natural_strains = {{0, 6, 0}};
  curved.torsional_stiffness = 0.7;
  expect_counts_add_up(curved);
  expect_counts_add_up(test::framed_clamps(1, 0.7, 0.7, 2));
}

TEST(SearchLog, ReportsWhatAFloorOmitsAndCountsShapesThatLieOnIt) {
  const Problem problem = test::over_floor(50, 0.1);
  expect_counts_add_up(problem);
  EXPECT_NE(omitted_text(search_energy(problem)).find("polygons"), std::string::npos);
}

TEST(SearchLog, ReportsThatTheTimeLimitInterruptedIt) {
  const EnergySearch search = search_energy(two_clamps(10, 0.6), {.time_limit = 1e-6});
  EXPECT_NE(omitted_text(search).find("time limit"), std::string::npos) << omitted_text(search);
  for (const Equilibrium& found : search.equilibria) {
    EXPECT_NE(found.message.find("time limit"), std::string::npos) << found.message;
  }
  const EnergySearch whole = search_energy(two_clamps(10, 0.6));
  EXPECT_EQ(omitted_text(whole).find("time limit"), std::string::npos) << omitted_text(whole);
}

TEST(SearchLog, ReportsThatThereAreMoreCombinationsThanItLists) {
  // Five clamps: four spans of several equilibria each.
  Problem problem = heavy_cantilever(10, 0);
  for (int i = 1; i < 5; ++i) {
    problem.grips.push_back({0.25 * i, {0.15 * i, 0, 0}, Eigen::Vector3d::UnitX()});
  }
  const EnergySearch search = search_energy(problem);
  EXPECT_EQ(search.equilibria.size(), 64U);
  EXPECT_NE(omitted_text(search).find("combinations"), std::string::npos) << omitted_text(search);
  EXPECT_TRUE(omitted_text(search_energy(heavy_cantilever(1, 0))).empty());
}

}  // namespace
}  // namespace dlo::energy_model
