#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/found_equilibria.hpp"
#include "random_problems.hpp"

namespace dlo::energy_model {
namespace {

double sum_of(const std::vector<std::vector<SpanCandidate>>& candidates,
              const std::vector<std::size_t>& choice) {
  double sum = 0;
  for (std::size_t i = 0; i < choice.size(); ++i) sum += candidates[i][choice[i]].energy;
  return sum;
}

TEST(LowestCombinations, AreThoseOfAFullEnumeration) {
  test::RandomNumbers random(3);
  std::vector<std::vector<SpanCandidate>> candidates(4);
  for (auto& own : candidates) {
    for (int k = 0; k < 5; ++k) own.push_back({true, random.uniform(-3, 3)});
  }
  std::vector<double> all;
  for (std::size_t c = 0; c < 625; ++c) {
    all.push_back(sum_of(candidates, {c % 5, c / 5 % 5, c / 25 % 5, c / 125}));
  }
  std::sort(all.begin(), all.end());
  for (const std::size_t most : {std::size_t{64}, std::size_t{1000}}) {
    const Combinations lowest = lowest_combinations(candidates, most);
    ASSERT_EQ(lowest.choices.size(), std::min<std::size_t>(most, 625));
    EXPECT_EQ(lowest.truncated, most < 625);
    for (std::size_t i = 0; i < lowest.choices.size(); ++i) {
      EXPECT_NEAR(sum_of(candidates, lowest.choices[i]), all[i], 1e-12) << i;
    }
  }
}

TEST(LowestCombinations, PutStableOnesFirstAndFailedOnesLast) {
  const double failed = std::numeric_limits<double>::quiet_NaN();
  const Combinations lowest = lowest_combinations(
      {{{false, -1}, {true, 5}, {true, 4}}, {{true, 2}, {true, 2.5}, {false, failed}}}, 64);
  const std::vector<std::vector<std::size_t>> expected = {{2, 0}, {2, 1}, {1, 0}, {1, 1}, {0, 0},
                                                          {0, 1}, {2, 2}, {1, 2}, {0, 2}};
  EXPECT_EQ(lowest.choices, expected);
  EXPECT_FALSE(lowest.truncated);
}

TEST(LowestCombinations, TakeBoundedTimeForManySpans) {
  // There are 6^200 combinations.
  const std::vector<std::vector<SpanCandidate>> candidates(
      200, {{true, 1}, {true, 2}, {true, 3}, {true, 4}, {true, 5}, {true, 6}});
  const Combinations lowest = lowest_combinations(candidates, 64);
  ASSERT_EQ(lowest.choices.size(), 64U);
  EXPECT_TRUE(lowest.truncated);
  EXPECT_EQ(sum_of(candidates, lowest.choices[0]), 200);
  EXPECT_EQ(sum_of(candidates, lowest.choices[1]), 201);
}

TEST(LowestCombinations, AreNoneIfASpanHasNone) {
  EXPECT_TRUE(lowest_combinations({{{true, 1}}, {}}, 64).choices.empty());
  EXPECT_FALSE(lowest_combinations({{{true, 1}}, {}}, 64).truncated);
}

}  // namespace
}  // namespace dlo::energy_model
