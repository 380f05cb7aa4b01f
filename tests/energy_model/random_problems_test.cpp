// Tests of the properties of the random problem generator, on which other tests rely.

#include "random_problems.hpp"

#include <gtest/gtest.h>

#include <set>

namespace dlo::energy_model {
namespace {

using test::random_problem;
using test::RandomSpace;

TEST(RandomNumbers, AreThoseOfSplitMix64) {
  // The reference implementation's first two numbers for the seed 1234567.
  test::RandomNumbers random(1234567);
  EXPECT_EQ(random.bits(), 6457827717110365317U);
  EXPECT_EQ(random.bits(), 3203168211198807973U);
}

TEST(RandomProblems, AreValidAndCanBeReached) {
  for (const RandomSpace space : {RandomSpace::plane, RandomSpace::space}) {
    for (std::uint64_t number = 0; number < 300; ++number) {
      SCOPED_TRACE(number);
      const Problem problem = random_problem(number, space);
      ASSERT_NO_THROW(check(problem));
      for (std::size_t i = 0; i + 1 < problem.grips.size(); ++i) {
        const Grip& one = problem.grips[i];
        const Grip& next = problem.grips[i + 1];
        EXPECT_GT(next.at - one.at, 0.0499);
        EXPECT_LT((next.position - one.position).norm(), 0.9995 * (next.at - one.at));
      }
      const double gamma = problem.weight_per_length.norm();
      EXPECT_TRUE(gamma >= 0.01 && gamma <= 1e4) << gamma;
      if (space == RandomSpace::space) continue;
      for (const Grip& grip : problem.grips) EXPECT_EQ(grip.position.z(), 0);
      for (const Load& load : problem.loads) EXPECT_EQ(load.force.z(), 0);
    }
  }
}

TEST(RandomProblems, CoverEveryNumberOfGripsAndLoads) {
  std::multiset<std::size_t> clamps;
  std::multiset<std::size_t> pins;
  std::multiset<std::size_t> loads;
  constexpr std::uint64_t count = 300;
  for (std::uint64_t number = 0; number < count; ++number) {
    const Problem problem = random_problem(number, RandomSpace::space);
    std::size_t held = 0;
    for (const Grip& grip : problem.grips) held += grip.direction ? 1 : 0;
    clamps.insert(held);
    pins.insert(problem.grips.size() - held);
    loads.insert(problem.loads.size());
  }
  for (std::size_t n = 0; n <= 3; ++n) {
    EXPECT_GE(clamps.count(n), 5U) << n;
    EXPECT_GE(pins.count(n), n < 3 ? 5U : 1U) << n;
    EXPECT_GE(loads.count(n), 10U) << n;
  }
}

TEST(RandomProblems, AreTheSameForTheSameNumber) {
  const Problem one = random_problem(17, RandomSpace::space);
  const Problem again = random_problem(17, RandomSpace::space);
  EXPECT_EQ(one.weight_per_length, again.weight_per_length);
  EXPECT_EQ(one.grips.back().position, again.grips.back().position);
  EXPECT_NE(one.weight_per_length, random_problem(18, RandomSpace::space).weight_per_length);
}

}  // namespace
}  // namespace dlo::energy_model
