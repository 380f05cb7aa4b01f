// Tests of many point loads: they approach a distributed load, and too many are refused before
// memory is allocated for them.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <stdexcept>
#include <string>
#include <vector>

#include "../says.hpp"
#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

/// Returns a cantilever whose weight, Gamma = 12, is divided into `count` loads, each in the middle
/// of its part.
Problem loaded(int count) {
  Problem problem = heavy_cantilever(0, 10);
  for (int i = 0; i < count; ++i) {
    problem.loads.push_back({(i + 0.5) / count, {0, -12.0 / count, 0}});
  }
  return problem;
}

// The middle of a part carries its weight with an error of the square of its length.
TEST(ManyLoads, BecomeTheWeightWithTheSquareOfTheirNumber) {
  const std::vector<double> s = {0.5, 1};
  const Eigen::Matrix3Xd weight = solve_energy(heavy_cantilever(12, 10)).sample(s).points;
  const auto apart = [&](int count) {
    const Equilibrium shape = test::converged(solve_energy(loaded(count)));
    return (shape.sample(s).points - weight).norm();
  };
  const double of_30 = apart(30);
  EXPECT_LT(of_30, 1e-3);
  EXPECT_NEAR(of_30 / apart(90), 9, 0.2);
}

TEST(ManyLoads, AreRefusedWhereTheirModelWouldTakeTheMemory) {
  EXPECT_TRUE(test::has_all(
      test::error_of<std::invalid_argument>([] { return solve_energy(loaded(2000)); }),
      {"2000 loads", "must be at most"}));
}

}  // namespace
}  // namespace dlo::energy_model
